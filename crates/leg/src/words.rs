//! Enums whose variants have stable words.

/// Defines an enum whose variants have stable words, which files, the command line and programs use: `ALL`, `WORDS`,
/// `word` and `of_word`. With `as serde`, whatever it derives of serde writes and reads the same words.
///
/// ```
/// gaiter_leg::word_enum! {
///     /// Which shoe.
///     #[derive(Debug, Clone, Copy, PartialEq)]
///     pub enum Shoe {
///         /// The left one.
///         Left => "left-shoe",
///         /// The right one.
///         Right => "right-shoe",
///     }
/// }
/// assert_eq!(Shoe::ALL.map(Shoe::word), ["left-shoe", "right-shoe"]);
/// assert_eq!(Shoe::of_word("right-shoe"), Some(Shoe::Right));
/// assert_eq!(Shoe::of_word("right"), None);
/// ```
#[macro_export]
macro_rules! word_enum {
    (@words $name:ident { $($variant:ident => $word:tt,)+ }) => {
        // Not every enum is listed, or read back.
        #[allow(dead_code)]
        impl $name {
            /// All of them, in the order of their definition.
            pub const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// All of them with their words, in the same order.
            pub const WORDS: [(&'static str, Self); [$($word),+].len()] =
                [$(($word, Self::$variant)),+];

            /// Its stable word.
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }

            /// The one with this word; `None` for an unknown word.
            pub fn of_word(word: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|of| of.word() == word)
            }
        }
    };
    (
        $(#[$of_enum:meta])*
        $visibility:vis enum $name:ident {
            $($(#[$of_variant:meta])* $variant:ident => $word:tt,)+
        }
    ) => {
        $(#[$of_enum])*
        $visibility enum $name {
            $($(#[$of_variant])* $variant,)+
        }
        $crate::word_enum! { @words $name { $($variant => $word,)+ } }
    };
    (
        $(#[$of_enum:meta])*
        $visibility:vis enum $name:ident as serde {
            $($(#[$of_variant:meta])* $variant:ident => $word:tt,)+
        }
    ) => {
        $(#[$of_enum])*
        $visibility enum $name {
            $($(#[$of_variant])* #[serde(rename = $word)] $variant,)+
        }
        $crate::word_enum! { @words $name { $($variant => $word,)+ } }
    };
}
