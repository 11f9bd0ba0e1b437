//! Stands for web-sys, as far as plotters calls it: it puts a text into the page to measure it. A worker has no page. Here a text is as
//! wide and high as plotters takes it to be outside browsers, so that a picture is the same in both.

use std::cell::Cell;
use wasm_bindgen::JsCast;

/// A window.
pub struct Window;
/// Its document.
pub struct Document;
/// Its body.
pub struct Body;
/// What never happens.
#[derive(Debug)]
pub struct Never;

/// A text to be measured.
#[derive(Debug, Default)]
pub struct Element {
    bytes: Cell<usize>,
    size_px: Cell<f64>,
}

/// The same in the page.
#[derive(Debug)]
pub struct Node(Element);
/// The same, laid out.
pub struct HtmlElement(Element);

/// The window.
pub fn window() -> Option<Window> {
    Some(Window)
}

impl Window {
    /// The document.
    pub fn document(&self) -> Option<Document> {
        Some(Document)
    }
}

impl Document {
    /// The body.
    pub fn body(&self) -> Option<Body> {
        Some(Body)
    }

    /// A new element.
    pub fn create_element(&self, _name: &str) -> Result<Element, Never> {
        Ok(Element::default())
    }
}

impl Body {
    /// Puts it into the page.
    pub fn append_with_node_1(&self, _node: &Node) -> Result<(), Never> {
        Ok(())
    }
}

impl Element {
    /// The text.
    pub fn set_text_content(&self, text: Option<&str>) {
        self.bytes.set(text.map_or(0, str::len));
    }

    /// The style, of which the font's size counts.
    pub fn set_attribute(&self, _name: &str, value: &str) -> Result<(), Never> {
        let size = value.split_once("font-size: ").and_then(|(_, rest)| rest.split_once("px"));
        self.size_px.set(size.and_then(|(size, _)| size.parse().ok()).ok_or(Never)?);
        Ok(())
    }
}

impl From<Element> for Node {
    fn from(element: Element) -> Self {
        Self(element)
    }
}

impl From<Node> for HtmlElement {
    fn from(node: Node) -> Self {
        Self(node.0)
    }
}

impl JsCast for Node {}

impl HtmlElement {
    fn em(&self) -> f64 {
        self.0.size_px.get() / 1.24 / 1.24
    }

    /// Pixels.
    pub fn offset_height(&self) -> i32 {
        (self.em().round() + (self.em() * 0.24).round()) as i32
    }

    /// Pixels.
    pub fn offset_width(&self) -> i32 {
        (self.em() * 0.7 * self.0.bytes.get() as f64).round() as i32
    }

    /// Takes it out of the page.
    pub fn remove(&self) {}
}
