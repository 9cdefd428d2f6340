//! What does an XML document say, whatever the case of its names?

use std::cell::RefCell;
use std::collections::BTreeSet;

use roxmltree::{Document, Node, ParsingOptions};

use super::super::error::{NEXT, RigFault};
use crate::nearest::line_number;

/// Most nodes of a document: 1,024 regions have some 40,000.
const MOST_NODES: u32 = 100_000;
/// Most attributes of an element: of those that are known, a dozen.
const MOST_ATTRIBUTES: usize = 200;

/// A document; one that declares entities is refused.
pub(super) fn parse(text: &str) -> Result<Document<'_>, RigFault> {
    // Each attribute is compared with those before it in its element, and each name space with all.
    let spaces = text.matches("xmlns:").count();
    let tags = text.split('<').map(|tag| tag.matches('=').count());
    if tags.max().unwrap_or(0) > MOST_ATTRIBUTES || spaces > MOST_ATTRIBUTES {
        let what = format!("an element has more than {MOST_ATTRIBUTES} attributes or name spaces");
        return Err(RigFault::new("", what, NEXT));
    }
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).map_err(|error| {
        let (line, what) = match error {
            // It does not say where.
            roxmltree::Error::DtdDetected => {
                let line = line_number(text, text.find("<!DOCTYPE").unwrap_or(0));
                (line, "it declares its own entities, which are not read")
            }
            _ => (error.pos().row as usize, &*error.to_string()),
        };
        RigFault::new(&format!("line {line}"), what, NEXT)
    })
}

/// Numbers of a document that were read with a decimal comma, by element and name.
#[derive(Debug, Default)]
pub(super) struct Commas(RefCell<BTreeSet<(usize, String)>>);

impl Commas {
    /// How many there are.
    pub(super) fn times(&self) -> usize {
        self.0.borrow().len()
    }
}

/// An element of a document.
#[derive(Clone, Copy)]
pub(super) struct XmlElement<'a> {
    node: Node<'a, 'a>,
    commas: &'a Commas,
}

impl<'a> XmlElement<'a> {
    pub(super) fn root(document: &'a Document<'a>, commas: &'a Commas) -> Self {
        Self {
            node: document.root_element(),
            commas,
        }
    }

    /// Another element of the document.
    fn other(self, node: Node<'a, 'a>) -> Self {
        Self { node, ..self }
    }

    /// Whether both are the same element.
    pub(super) fn is(self, other: Self) -> bool {
        self.node == other.node
    }

    pub(super) fn is_called(self, name: &str) -> bool {
        self.node.tag_name().name().eq_ignore_ascii_case(name)
    }

    /// The names of the elements directly in it.
    pub(super) fn child_names(self) -> impl Iterator<Item = &'a str> {
        let all = self.node.children().filter(Node::is_element);
        all.map(|it| it.tag_name().name())
    }

    /// The elements directly in it of a name.
    pub(super) fn children(self, name: &str) -> impl Iterator<Item = Self> {
        let all = self.node.children().filter(Node::is_element);
        all.map(move |node| self.other(node))
            .filter(move |it| it.is_called(name))
    }

    pub(super) fn child(self, name: &str) -> Option<Self> {
        self.children(name).next()
    }

    /// The elements of a name anywhere in it, itself among them.
    pub(super) fn all_within(self, name: &str) -> impl Iterator<Item = Self> {
        let all = self.node.descendants().filter(Node::is_element);
        all.map(move |node| self.other(node))
            .filter(move |it| it.is_called(name))
    }

    pub(super) fn attribute(self, name: &str) -> Option<&'a str> {
        let mut all = self.node.attributes();
        let found = all.find(|it| it.name().eq_ignore_ascii_case(name));
        found.map(|it| it.value().trim())
    }

    /// What stands in a child of a name, or in an attribute.
    pub(super) fn said(self, name: &str) -> Option<&'a str> {
        let child = self.child(name).and_then(|it| it.node.text());
        let said = child.map(str::trim).or_else(|| self.attribute(name));
        said.filter(|it| !it.is_empty())
    }

    /// A finite number in a child or an attribute; `None` where there is none.
    pub(super) fn number(self, name: &str) -> Result<Option<f64>, RigFault> {
        let Some(text) = self.said(name) else {
            return Ok(None);
        };
        // Programs write commas where their users do.
        let is_comma = text.matches(',').count() == 1 && !text.contains('.');
        let plain = if is_comma {
            let place = (self.node.range().start, name.to_lowercase());
            self.commas.0.borrow_mut().insert(place);
            text.replace(',', ".")
        } else {
            text.to_owned()
        };
        let number = plain.parse().ok().filter(|it: &f64| it.is_finite());
        let text: String = text.chars().take(40).collect();
        number
            .map(Some)
            .ok_or_else(|| self.fault(name, format!("{text:?} is not a number")))
    }

    /// What is wrong with what it says of a name.
    pub(super) fn fault(self, name: &str, what: impl Into<String>) -> RigFault {
        let text = self.node.document().input_text();
        let line = line_number(text, self.node.range().start);
        let own = self.node.tag_name().name();
        let id = self.attribute("id").or_else(|| self.attribute("region"));
        let id = id.map(|id| format!(" {:?}", id.chars().take(40).collect::<String>()));
        let dot = if name.is_empty() { "" } else { ", " };
        let place = format!("line {line}, {own}{}{dot}{name}", id.unwrap_or_default());
        RigFault::new(&place, what, NEXT)
    }
}
