//! What the cells are: the settings in which they differ.

use super::text::escaped;
use crate::report::study::{Setting, Settings, Study};

/// Most settings that are shown without being asked for.
const MAX_OPEN: usize = 12;
/// Texts of more characters get room for more than a word or two in a line.
const LONG: usize = 40;

impl Study {
    /// The section with a table for each axis, or each few, that decide something; nothing where no two cells differ.
    pub(super) fn cells_section(&self) -> String {
        if self.settings.is_empty() {
            return String::new();
        }
        let n: usize = self.settings.iter().map(|settings| settings.settings.len()).sum();
        let open = if n <= MAX_OPEN { " open" } else { "" };
        let tables: String = self.settings.iter().map(|settings| table(settings, open)).collect();
        format!(
            "<section id=\"cells\"><h2>Cells</h2><p>What the levels of each axis set, by the paths of the spec; faint where it is \
             as with the first. All else is the same in all cells.</p>{tables}</section>\n"
        )
    }
}

fn table(Settings { axes, levels, settings }: &Settings, open: &str) -> String {
    let axes: Vec<String> = axes.iter().map(|axis| escaped(axis)).collect();
    let levels: Vec<String> = levels.iter().map(|level| escaped(&level.join(" \u{b7} "))).collect();
    let head: String = levels.iter().map(|level| format!("<th scope=\"col\">{level}</th>")).collect();
    let rows: String = settings.iter().map(|setting| row(setting, &levels)).collect();
    format!(
        "<details{open}><summary>{}: {} setting{}</summary><div class=\"scroll\" tabindex=\"0\"><table class=\"settings\"><thead><tr>\
         <th scope=\"col\">path</th>{head}</tr></thead><tbody>{rows}</tbody></table></div></details>\n",
        axes.join(" \u{d7} "),
        settings.len(),
        if settings.len() == 1 { "" } else { "s" },
    )
}

/// A setting; each cell names its level, for windows too narrow for a column each.
fn row(Setting { path, values }: &Setting, levels: &[String]) -> String {
    let cell = |(k, (value, level)): (usize, (&Option<String>, &String))| {
        let faint = if k > 0 && *value == values[0] { "as-first" } else { "" };
        let long = if value.as_ref().is_some_and(|value| value.chars().count() > LONG) { " long" } else { "" };
        let text = value.as_ref().map_or_else(|| "\u{2013}".to_owned(), |value| escaped(value));
        format!("<td class=\"{faint}{long}\" data-level=\"{level}\"><code>{text}</code></td>")
    };
    let cells: String = values.iter().zip(levels).enumerate().map(cell).collect();
    format!("<tr><th scope=\"row\"><code>{}</code></th>{cells}</tr>\n", escaped(path))
}
