//! Choices: numbers that are neither physics nor from a data sheet. Each has a unit, a meaning and a source, is found by name,
//! and is listed by `magcomp sensitivity`, which halves and doubles it and prints what that does.

/// A choice as it is listed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Name, unique within its estimator.
    pub name: &'static str,
    /// Unit; empty for a ratio, a count or a logarithm.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Where the value comes from.
    pub source: &'static str,
    /// The value in use.
    pub value: f64,
}

/// Declares a struct of choices: `name: value, "unit", "source";` with the meaning as its doc comment.
macro_rules! choices {
    ($(#[doc = $about:literal])+ $name:ident {
        $($(#[doc = $meaning:literal])+ $field:ident: $value:expr, $unit:literal, $source:literal;)+
    }) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct $name {
            $($(#[doc = $meaning])+ pub $field: f64,)+
        }

        impl $name {
            /// What phones get.
            pub const USED: Self = Self { $($field: $value,)+ };

            /// Every choice.
            #[allow(dead_code, reason = "only those of the estimators are tried by `magcomp sensitivity`")]
            pub const LIST: &[$crate::tuning::Choice] = &[$($crate::tuning::Choice {
                name: stringify!($field),
                unit: $unit,
                meaning: concat!($($meaning),+),
                source: $source,
                value: $value,
            }),+];

            /// Sets a choice by its name; whether there is one.
            #[allow(dead_code, reason = "as of `LIST`")]
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $(stringify!($field) => self.$field = value,)+
                    _ => return false,
                }
                true
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self::USED
            }
        }
    };
}
pub(crate) use choices;
