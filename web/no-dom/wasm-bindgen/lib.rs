//! Stands for wasm-bindgen, as far as plotters calls it.

/// A thing of a page that may be one of a narrower kind.
pub trait JsCast: Sized {
    /// As that kind.
    ///
    /// # Errors
    /// The thing itself, where it is of another.
    fn dyn_into<T: From<Self>>(self) -> Result<T, Self> {
        Ok(T::from(self))
    }
}
