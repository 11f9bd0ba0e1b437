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

/// A mechanism of a model that can be switched off, to see what it is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mechanism {
    /// Name, unique within its estimator.
    pub name: &'static str,
    /// What is not there without it.
    pub meaning: &'static str,
}

/// Declares a struct of choices: `name: value, "unit", "source";` with the meaning as its doc comment;
/// and the mechanisms that can be switched off.
macro_rules! choices {
    ($(#[doc = $about:literal])* $name:ident {
        $($(#[doc = $meaning:literal])+ $field:ident: $value:expr, $unit:literal, $source:literal;)*
    } mechanisms {
        $($(#[doc = $what:literal])+ $switch:ident;)+
    }) => {
        $(#[doc = $about])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        pub(crate) struct $name {
            $($(#[doc = $meaning])+ pub $field: f64,)*
            $($(#[doc = $what])+ pub $switch: bool,)+
        }

        #[allow(dead_code, unreachable_code, unused_variables, reason = "not every part has choices that are tried by `magcomp sensitivity`")]
        impl $name {
            /// What phones get.
            pub const USED: Self = Self { $($field: $value,)* $($switch: true,)+ };

            /// Every choice.
            pub const LIST: &[$crate::tuning::Choice] = &[$($crate::tuning::Choice {
                name: stringify!($field),
                unit: $unit,
                meaning: concat!($($meaning),+),
                source: $source,
                value: $value,
            }),*];

            /// Every mechanism that can be switched off.
            pub const MECHANISMS: &[$crate::tuning::Mechanism] = &[$($crate::tuning::Mechanism {
                name: stringify!($switch),
                meaning: concat!($($what),+),
            }),+];

            /// Switches a mechanism off by its name; whether there is one.
            pub fn switch_off(&mut self, name: &str) -> bool {
                match name {
                    $(stringify!($switch) => self.$switch = false,)+
                    _ => return false,
                }
                true
            }

            /// Sets a choice by its name; whether there is one.
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $(stringify!($field) => self.$field = value,)*
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
