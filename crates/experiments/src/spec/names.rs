//! Names: what tables, plots and folders are called.

/// Refuses a name that looks like another one, or like none.
pub(crate) fn check_label(name: &str) -> Result<(), &'static str> {
    if name.trim().is_empty() {
        Err("must not be empty")
    } else if name.trim() != name {
        Err("must not begin or end with a blank")
    } else if name.chars().any(char::is_control) {
        Err("must not hold line breaks or other control characters")
    } else {
        Ok(())
    }
}

/// Refuses a name that is no name of a folder: results are kept in `results/NAME`.
pub(crate) fn check_folder(name: &str) -> Result<(), &'static str> {
    check_label(name)?;
    if name.contains(['/', '\\']) || name == "." || name == ".." {
        return Err("must be the name of a folder, not a path: no `/`, no `\\`, not `.` or `..`");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_folders() {
        for name in ["quick", "10x15", "a b", "über", "a.b", "...", "-"] {
            assert_eq!(check_folder(name), Ok(()), "{name:?}");
        }
        for name in ["", " ", " a", "a\t", "a\nb", "a\0", "../evil", "/etc", "a/b", "a\\b", ".", ".."] {
            assert!(check_folder(name).is_err(), "{name:?}");
        }
    }

    #[test]
    fn a_label_may_hold_what_a_folder_may_not() {
        assert_eq!((check_label("R/R_couple"), check_label("..")), (Ok(()), Ok(())));
        assert!(check_label("10x15 ").is_err());
    }
}
