//! What the conversions share.

/// Conversions both ways between enums without data that have the same names here and in the core.
macro_rules! same_names {
    ($($name:ident { $($variant:ident),+ })+) => {$(
        impl From<magcomp::$name> for $name {
            fn from(value: magcomp::$name) -> Self {
                match value { $(magcomp::$name::$variant => Self::$variant),+ }
            }
        }
        impl From<$name> for magcomp::$name {
            fn from(value: $name) -> Self {
                match value { $($name::$variant => Self::$variant),+ }
            }
        }
    )+};
}
pub(crate) use same_names;

/// A count as the border carries it.
pub(crate) fn count(n: usize) -> i32 {
    i32::try_from(n).unwrap_or(i32::MAX)
}

/// A count of the border's, as the core has it.
pub(crate) fn size(n: i32) -> usize {
    usize::try_from(n).unwrap_or(0)
}

/// 1 to 3, or negative; anything else is none.
pub(crate) fn axis_of(n: i32) -> i8 {
    i8::try_from(n).unwrap_or(0)
}
