//! Of what does one part of the report consist, and how does it read?

use crate::commands::demo::video::pictures::Png;
use crate::report::html::escape;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;

/// Pictures narrower than this are shown with their pixels visible.
const SMALL: u32 = 400;
/// Less than this share saved is little gained.
const LITTLE: f64 = 0.2;

/// What one content shows: what it is, what it takes, how good it looks.
pub(crate) struct ReportPart {
    pub(crate) title: String,
    /// What is shown, in paragraphs of HTML.
    pub(crate) facts: String,
    pub(crate) cards: Vec<Card>,
    /// Why little is gained, where that is so; a sentence without its beginning, as HTML.
    pub(crate) little: Option<String>,
    /// Pictures with a heading, as HTML.
    pub(crate) pictures: String,
    pub(crate) plot: Plot,
    pub(crate) table: Table,
    /// How long all of it took, preparing included.
    pub(crate) took_s: f64,
}

/// A figure that is read first.
pub(crate) struct Card {
    pub(crate) name: &'static str,
    pub(crate) value: String,
    /// What it is compared with, a line each.
    pub(crate) notes: Vec<String>,
}

/// A plot over time.
pub(crate) struct Plot {
    pub(crate) title: &'static str,
    pub(crate) text: &'static str,
    pub(crate) svg: String,
}

/// Figures of every policy.
pub(crate) struct Table {
    pub(crate) title: String,
    pub(crate) columns: Vec<&'static str>,
    pub(crate) rows: Vec<FigureRow>,
}

/// One row: what, in which unit, and a cell a column.
pub(crate) struct FigureRow {
    pub(crate) what: String,
    pub(crate) unit: &'static str,
    pub(crate) cells: Vec<String>,
    /// Whether it begins another kind of figures.
    pub(crate) opens_group: bool,
}

/// Whether what is taken in place of `baseline` saves less than a fifth of it.
pub(crate) fn is_little(own: f64, baseline: f64) -> bool {
    own > (1.0 - LITTLE) * baseline
}

impl ReportPart {
    /// The part as a section of the page, which `anchor` names.
    pub(crate) fn html(&self, anchor: &str) -> String {
        let cards: String = self.cards.iter().map(Card::html).collect();
        let little = self.little.as_ref().map_or(String::new(), |why| {
            format!("<p class=\"little\">Little gained here, because {why}.</p>\n")
        });
        let Plot { title, text, svg } = &self.plot;
        format!(
            "<section id=\"{anchor}\">\n<h2>{}</h2>\n{}<dl class=\"cards\">\n{cards}</dl>\n\
             {little}{}<h3>Over time</h3>\n<figure class=\"plot\">\
             <figcaption><b>{title}.</b> {text}</figcaption>\n{svg}</figure>\n{}\
             <p class=\"soft\">This part took {:.0}&#8239;s.</p>\n</section>\n",
            escape(&self.title),
            self.facts,
            self.pictures,
            self.table.html(),
            self.took_s,
        )
    }

    /// The same for a terminal.
    pub(crate) fn text(&self) -> String {
        let little = self.little.as_ref().map_or(String::new(), |why| {
            format!("Little gained here, because {}.\n", plain(why))
        });
        format!(
            "{}, {:.0} s\n{}{little}",
            self.title,
            self.took_s,
            self.table.text()
        )
    }
}

impl Card {
    fn html(&self) -> String {
        let notes: String = self
            .notes
            .iter()
            .map(|note| format!("<span>{note}</span>"))
            .collect();
        let Self { name, value, .. } = self;
        format!("<div><dt>{name}</dt><dd><b>{value}</b>{notes}</dd></div>\n")
    }
}

impl Table {
    fn html(&self) -> String {
        let head: String = self
            .columns
            .iter()
            .map(|name| format!("<th scope=\"col\" class=\"{name}\">{name}</th>"))
            .collect();
        let body: String = self.rows.iter().map(FigureRow::html).collect();
        format!(
            "<h3>{}</h3>\n<table>\n<thead><tr><th></th>{head}</tr></thead>\n\
             <tbody>\n{body}</tbody>\n</table>\n",
            self.title
        )
    }

    fn text(&self) -> String {
        let mut text = format!("{:<44}", "");
        for name in &self.columns {
            let _ = write!(text, "{name:>11}");
        }
        text.push('\n');
        for row in &self.rows {
            let label = match row.unit {
                "" => row.what.clone(),
                unit => format!("{}, {unit}", row.what),
            };
            let _ = write!(text, "{label:<44}");
            for cell in &row.cells {
                let _ = write!(text, "{cell:>11}");
            }
            text.push('\n');
        }
        text
    }
}

impl FigureRow {
    fn html(&self) -> String {
        let cells: String = self
            .cells
            .iter()
            .map(|cell| format!("<td>{cell}</td>"))
            .collect();
        let unit = match self.unit {
            "" => String::new(),
            unit => format!(" <span>{unit}</span>"),
        };
        let class = match self.opens_group {
            true => " class=\"first\"",
            false => "",
        };
        let what = &self.what;
        format!("<tr{class}><th scope=\"row\">{what}{unit}</th>{cells}</tr>\n")
    }
}

/// A picture that a click shows larger; `class` says how much room it gets.
pub(crate) fn picture(class: &str, png: &Png, title: &str, text: &str) -> String {
    let [width, height] = png.size;
    let small = match width < SMALL {
        true => " class=\"small\"",
        false => "",
    };
    format!(
        "<figure class=\"{class}\"><label><input type=\"checkbox\" aria-label=\"{title}, larger\">\
         <img{small} width=\"{width}\" height=\"{height}\" alt=\"{title}\" \
         src=\"data:image/png;base64,{}\"></label>\
         <figcaption><b>{title}.</b> {text}</figcaption></figure>\n",
        STANDARD.encode(&png.bytes)
    )
}

/// HTML of one sentence without its tags.
fn plain(html: &str) -> String {
    let mut is_tag = false;
    html.chars()
        .filter(|c| match c {
            '<' | '>' => {
                is_tag = *c == '<';
                false
            }
            _ => !is_tag,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn less_than_a_fifth_saved_is_little() {
        assert!(is_little(0.81, 1.0) && is_little(2.0, 1.0));
        assert!(!is_little(0.79, 1.0));
    }

    #[test]
    fn a_terminal_shows_no_tags() {
        assert_eq!(plain("of <code>full</code> 3 %"), "of full 3 %");
    }
}
