//! Reading a tree into typed structs, so that every mistake knows its dotted path.
//!
//! The tree is the same whether it was written by hand or put together by a sweep, and so are the
//! messages. There is one convention beyond serde's: an enum whose serde name is `tag:law=impact` is a
//! section whose key `law` names the variant. Where the key is left out, the variant is `impact`; with
//! `tag:measure` the key is required. serde's own `tag` attribute would lose the path. That of schemars
//! stays, for the schema.

use crate::error::{Error, nearest, shown, unexpected};
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, EnumAccess, Error as _, IntoDeserializer, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};
use serde::{Deserialize, Deserializer, forward_to_deserialize_any};
use serde_json::{Map, Value};

/// Reads `tree` as a `T`.
pub(crate) fn read<'de, T: Deserialize<'de>>(tree: &'de Value) -> Result<T, Error> {
    T::deserialize(Reader::new(tree))
}

/// A node of the tree.
#[derive(Clone, Copy)]
struct Reader<'de> {
    node: &'de Value,
    /// A key of this section that has been read already.
    skip: Option<&'static str>,
}

impl<'de> Reader<'de> {
    fn new(node: &'de Value) -> Self {
        Self { node, skip: None }
    }

    fn mismatch(&self, expected: &str) -> Error {
        Error::unexpected("", shown(self.node), expected)
    }

    /// The variant of an enum that a section's key `tag` names.
    fn tagged<V: Visitor<'de>>(self, tag: &'static str, visitor: V) -> Result<V::Value, Error> {
        let (tag, default) = match tag.split_once('=') {
            Some((tag, default)) => (tag, Some(default)),
            None => (tag, None),
        };
        let Value::Object(section) = self.node else {
            return Err(self.mismatch(&format!("a section with the key {tag}")));
        };
        let name = match section.get(tag) {
            Some(Value::String(name)) => name,
            Some(other) => {
                return Err(Reader::new(other).mismatch("a name, as text").under(tag));
            }
            None => match section.keys().find(|key| nearest(key, [tag]).is_some()) {
                Some(misspelt) => return Err(Error::unknown_key(misspelt, &[tag])),
                None => default.ok_or_else(|| Error::missing(tag))?,
            },
        };
        let content = Reader {
            node: self.node,
            skip: Some(tag),
        };
        visitor.visit_enum(Variant {
            name,
            key: Some(tag),
            content,
        })
    }
}

impl<'de> Deserializer<'de> for Reader<'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.node {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Number(_) => match unexpected(self.node) {
                Unexpected::Unsigned(value) => visitor.visit_u64(value),
                Unexpected::Signed(value) => visitor.visit_i64(value),
                Unexpected::Float(value) => visitor.visit_f64(value),
                _ => Err(self.mismatch("a number")),
            },
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Array(all) => {
                let items = all.iter().enumerate();
                let mut items = Items { items };
                let read = visitor.visit_seq(&mut items)?;
                match items.items.len() {
                    0 => Ok(read),
                    left => Err(of_length(all.len(), all.len() - left)),
                }
            }
            Value::Object(section) => visitor.visit_map(Entries {
                entries: section.iter(),
                skip: self.skip,
                next: None,
            }),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.node {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        keys: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.node {
            Value::Object(_) => self.deserialize_any(visitor),
            _ => Err(self.mismatch(&format!("a section with the keys {}", keys.join(", ")))),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.node {
            Value::Array(_) => self.deserialize_any(visitor),
            _ => Err(self.mismatch("a list")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.node {
            Value::Array(items) if items.len() == length => self.deserialize_any(visitor),
            Value::Array(items) => Err(of_length(items.len(), length)),
            _ => Err(self.mismatch(&format!("a list of {length}"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.node {
            Value::Object(_) => self.deserialize_any(visitor),
            _ => Err(self.mismatch("a section")),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.node {
            Value::String(text) => visitor.visit_borrowed_str(text),
            _ => Err(self.mismatch("text")),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        if let Some(tag) = name.strip_prefix("tag:") {
            return self.tagged(tag, visitor);
        }
        let (name, content) = match self.node {
            Value::String(name) => (name, &Value::Null),
            Value::Object(section) => match single(section) {
                Some(entry) => entry,
                None => {
                    let list = format!("a section with one of the keys {}", variants.join(", "));
                    let keys: Vec<&str> = section.keys().map(String::as_str).collect();
                    let found = match keys[..] {
                        [] => "an empty section".to_owned(),
                        _ => format!("the keys {}", keys.join(", ")),
                    };
                    return Err(Error::unexpected("", found, list));
                }
            },
            _ => return Err(self.mismatch(&format!("one of {}", variants.join(", ")))),
        };
        visitor.visit_enum(Variant {
            name,
            key: None,
            content: Reader::new(content),
        })
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str bytes byte_buf unit
        unit_struct tuple_struct identifier ignored_any
    }
}

/// A list of `found` items where `length` belong.
fn of_length(found: usize, length: usize) -> Error {
    Error::invalid_length(found, &format!("a list of {length}").as_str())
}

fn single(section: &Map<String, Value>) -> Option<(&String, &Value)> {
    let mut entries = section.iter();
    entries.next().filter(|_| entries.next().is_none())
}

struct Items<'de> {
    items: std::iter::Enumerate<std::slice::Iter<'de, Value>>,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        let Some((index, item)) = self.items.next() else {
            return Ok(None);
        };
        let read = seed.deserialize(Reader::new(item));
        read.map(Some).map_err(|error| error.under(index))
    }
}

struct Entries<'de> {
    entries: serde_json::map::Iter<'de>,
    skip: Option<&'static str>,
    next: Option<(&'de String, &'de Value)>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Error> {
        let skip = self.skip;
        self.next = self.entries.find(|(key, _)| Some(key.as_str()) != skip);
        match self.next {
            Some((key, _)) => {
                let key: StrDeserializer<Error> = key.as_str().into_deserializer();
                seed.deserialize(key).map(Some)
            }
            None => Ok(None),
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Error> {
        let (key, value) = self
            .next
            .take()
            .ok_or_else(|| Error::custom("a value was read before its key"))?;
        let read = seed.deserialize(Reader::new(value));
        read.map_err(|error| error.under(key))
    }
}

struct Variant<'de> {
    name: &'de str,
    /// The key whose value names the variant; none where the variant is the key itself.
    key: Option<&'static str>,
    content: Reader<'de>,
}

impl<'de> EnumAccess<'de> for Variant<'de> {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Error> {
        let name: StrDeserializer<Error> = self.name.into_deserializer();
        let variant = seed.deserialize(name).map_err(|error| match self.key {
            Some(key) => error.under(key),
            None => error,
        })?;
        Ok((variant, self))
    }
}

impl<'de> Variant<'de> {
    /// Mistakes inside a variant that is a key stand below that key.
    fn inside(key: Option<&str>, name: &str, error: Error) -> Error {
        match key {
            Some(_) => error,
            None => error.under(name),
        }
    }
}

impl<'de> VariantAccess<'de> for Variant<'de> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Nothing {}
        if self.content.node.is_null() {
            return Ok(());
        }
        Nothing::deserialize(self.content)
            .map(|_| ())
            .map_err(|error| Self::inside(self.key, self.name, error))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(self.content)
            .map_err(|error| Self::inside(self.key, self.name, error))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Error> {
        self.content
            .deserialize_seq(visitor)
            .map_err(|error| Self::inside(self.key, self.name, error))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        keys: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.content
            .deserialize_struct("", keys, visitor)
            .map_err(|error| Self::inside(self.key, self.name, error))
    }
}
