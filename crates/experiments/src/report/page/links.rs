//! Links from the page to the folders of runs.

use std::path::{Component, Path, PathBuf};

/// The link from a page in one folder to another folder, as part of a URL that ends in a slash.
pub(super) fn relative(from: &Path, to: &Path) -> String {
    let whole = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let (from, to) = (whole(from), whole(to));
    let n_common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(n_common).map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(to.components().skip(n_common)).collect();
    let parts = path.components().map(|part| encoded(&part.as_os_str().to_string_lossy()) + "/");
    Some(parts.collect::<String>()).filter(|link| !link.is_empty()).unwrap_or_else(|| "./".to_owned())
}

/// A part of a path as URLs have it.
fn encoded(part: &str) -> String {
    let mut url = String::new();
    for byte in part.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => url.push(byte.into()),
            _ => url.push_str(&format!("%{byte:02X}")),
        }
    }
    url
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_found_from_where_the_page_is() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = |name: &str| {
            let path = temporary.path().join(name);
            std::fs::create_dir_all(&path).unwrap();
            path
        };
        let results = folder("results/a #1");
        assert_eq!(relative(&results, &results), "./");
        assert_eq!(relative(&folder("results"), &results), "a%20%231/");
        assert_eq!(relative(&folder("pages/new"), &results), "../../results/a%20%231/");
    }
}
