//! Findings as data: a stable code, and figures by name.

/// A statement: its texts are in the language files under its code.
#[derive(Debug, Clone, PartialEq)]
pub struct Said {
    /// The stable code.
    pub code: &'static str,
    /// The figures by name. Names end with the unit.
    pub figures: Vec<(&'static str, Figure)>,
}

/// A figure of a statement.
#[derive(Debug, Clone, PartialEq)]
pub enum Figure {
    /// A number.
    Number(f64),
    /// The name of a level, or words that are English in every language.
    Name(String),
    /// A reason with figures of its own.
    Reason(Said),
}

/// What can be a figure.
pub(crate) trait AsFigure {
    /// The figure; `None` for what only chooses between texts.
    fn figure(&self) -> Option<Figure>;
}

impl AsFigure for f64 {
    fn figure(&self) -> Option<Figure> {
        Some(Figure::Number(*self))
    }
}

impl AsFigure for usize {
    fn figure(&self) -> Option<Figure> {
        Some(Figure::Number(*self as f64))
    }
}

impl AsFigure for String {
    fn figure(&self) -> Option<Figure> {
        Some(Figure::Name(self.clone()))
    }
}

impl Said {
    pub(crate) fn new(code: &'static str) -> Said {
        Said { code, figures: Vec::new() }
    }

    pub(crate) fn with(mut self, name: &'static str, figure: &impl AsFigure) -> Said {
        self.figures.extend(figure.figure().map(|figure| (name, figure)));
        self
    }
}

/// Defines an enum whose variants have stable codes and figures: `code` and `said`. Each field is a figure of the
/// same name. A variant behind `or` has code and figures of what is in it.
macro_rules! coded_enum {
    (
        $(#[$of_enum:meta])*
        $visibility:vis enum $name:ident {
            $(
                $(#[$of_variant:meta])*
                $variant:ident $({
                    $($(#[$of_field:meta])* $field:ident: $type:ty,)+
                })? => $code:literal,
            )+
        }
        $(or {
            $($(#[$of_other:meta])* $other:ident($(#[$of_inner:meta])* $inner:ty),)+
        })?
    ) => {
        $(#[$of_enum])*
        $visibility enum $name {
            $($(#[$of_variant])* $variant $({ $($(#[$of_field])* $field: $type,)+ })?,)+
            $($($(#[$of_other])* $other($(#[$of_inner])* $inner),)+)?
        }

        impl $name {
            /// Its stable code.
            pub fn code(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $code,)+
                    $($(Self::$other(inner) => inner.code(),)+)?
                }
            }

            /// Its code and figures.
            pub fn said(&self) -> $crate::figure::Said {
                match self {
                    $(Self::$variant $({ $($field,)+ })? => {
                        $crate::figure::Said::new($code)$($(.with(stringify!($field), $field))+)?
                    })+
                    $($(Self::$other(inner) => inner.said(),)+)?
                }
            }
        }

        impl $crate::figure::AsFigure for $name {
            fn figure(&self) -> Option<$crate::figure::Figure> {
                Some($crate::figure::Figure::Reason(self.said()))
            }
        }
    };
}
