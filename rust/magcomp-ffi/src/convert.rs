//! What the conversions share.

/// A value as the other side of the border has it.
pub(crate) trait Cross<To> {
    fn cross(self) -> To;
}

macro_rules! cross {
    ($($from:ty => $to:ty: |$value:ident| $made:expr;)+) => {$(
        impl Cross<$to> for $from {
            fn cross(self) -> $to {
                let $value = self;
                $made
            }
        }
    )+};
}

cross! {
    usize => i32: |n| count(n);
    i32 => usize: |n| usize::try_from(n).unwrap_or(0);
    // an axis: 1 to 3, or negative; anything else is none
    i8 => i32: |n| n.into();
    i32 => i8: |n| i8::try_from(n).unwrap_or(0);
    i64 => i64: |n| n;
    f64 => f64: |n| n;
}

/// Conversions both ways between an enum here and one of the core. What stands alone in a case of the core has a name here.
macro_rules! same {
    ($($name:ident: $core:ident { $($case:ident $(($only:ident))? $({ $($field:ident),+ })?),+ })+) => {$(
        impl From<magcomp::$core> for $name {
            fn from(it: magcomp::$core) -> Self {
                match it {
                    $(magcomp::$core::$case $(($only))? $({ $($field),+ })?
                        => Self::$case $({ $only: $only.into() })? $({ $($field: $crate::convert::Cross::cross($field)),+ })?),+
                }
            }
        }
        impl From<$name> for magcomp::$core {
            fn from(it: $name) -> Self {
                match it {
                    $($name::$case $({ $only })? $({ $($field),+ })?
                        => Self::$case $(($only.into()))? $({ $($field: $crate::convert::Cross::cross($field)),+ })?),+
                }
            }
        }
    )+};
}
pub(crate) use same;

/// A count as the border carries it.
pub(crate) fn count(n: usize) -> i32 {
    i32::try_from(n).unwrap_or(i32::MAX)
}
