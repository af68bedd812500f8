//! What a spec can hold, in memory: enough of serde to write a reward to a spec and read it back.
//!
//! As strict as TOML, so that a reward that passes here can be written in a spec: keys are strings, integers are those
//! of `i64`, an absent option leaves its key out, and there is no null.

use crate::serde_error::SerdeError;
use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer};
use serde::de::{Deserializer, Error, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;

mod serializer;

pub(crate) use serializer::to_value;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// An absent option; never inside a sequence or a map.
    None,
    Bool(bool),
    Integer(i64),
    Float(f64),
    String(String),
    Seq(Vec<Value>),
    Map(Vec<(String, Value)>),
}

impl IntoDeserializer<'_, SerdeError> for Value {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Value {
    type Error = SerdeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, SerdeError> {
        match self {
            Self::None => visitor.visit_none(),
            Self::Bool(value) => visitor.visit_bool(value),
            Self::Integer(value) => visitor.visit_i64(value),
            Self::Float(value) => visitor.visit_f64(value),
            Self::String(value) => visitor.visit_string(value),
            Self::Seq(values) => visitor.visit_seq(SeqDeserializer::new(values.into_iter())),
            Self::Map(entries) => visitor.visit_map(MapDeserializer::new(entries.into_iter())),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, SerdeError> {
        match self {
            Self::None => visitor.visit_none(),
            value => visitor.visit_some(value),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, SerdeError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, SerdeError> {
        match self {
            Self::String(variant) => visitor.visit_enum(variant.into_deserializer()),
            Self::Map(entries) => {
                let map = MapDeserializer::new(entries.into_iter());
                visitor.visit_enum(MapAccessDeserializer::new(map))
            }
            _ => Err(SerdeError::custom(format!("expected a variant of {name}"))),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::{Deserialize, Serialize};
    use std::collections::BTreeMap;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    enum Shape {
        Point,
        Disc(f64),
        Pair(u8, i16),
        Box { length: f32, width: Option<f32> },
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Metres(f64);

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Everything {
        flag: bool,
        letter: char,
        text: String,
        count: u32,
        some: Option<f64>,
        none: Option<f64>,
        newtype: Metres,
        tuple: (f64, bool),
        map: BTreeMap<String, i32>,
        shapes: Vec<Shape>,
    }

    fn everything() -> Everything {
        Everything {
            flag: true,
            letter: 'z',
            text: "words".to_owned(),
            count: 7,
            some: Some(0.1),
            none: None,
            newtype: Metres(2.5),
            tuple: (1.0, false),
            map: BTreeMap::from([("a".to_owned(), -1)]),
            shapes: vec![Shape::Point, Shape::Disc(0.3), Shape::Pair(1, -2), Shape::Box { length: 0.5, width: None }],
        }
    }

    #[test]
    fn all_that_serde_knows_survives() {
        let value = to_value(&everything()).unwrap();
        assert_eq!(Everything::deserialize(value).unwrap(), everything());
    }

    #[test]
    fn an_absent_option_leaves_its_key_out() {
        let Value::Map(entries) = to_value(&everything()).unwrap() else { unreachable!("a struct is a map") };
        assert!(entries.iter().all(|(key, _)| key != "none"));
        assert_eq!(entries.len(), 9);
    }

    #[test]
    fn what_toml_cannot_hold_is_refused() {
        let error = |result: Result<Value, SerdeError>| result.unwrap_err().to_string();
        assert_eq!(error(to_value(&u64::MAX)), "18446744073709551615 does not fit an integer");
        assert_eq!(error(to_value(&[None::<f64>])), "a sequence cannot hold nothing");
        assert_eq!(error(to_value(&())), "a spec cannot hold a unit");
        let keyed = BTreeMap::from([(1, 2)]);
        assert_eq!(error(to_value(&keyed)), "a key must be a string");
    }
}
