//! Schemas from types.

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::Value;

/// The schema (draft 2020-12) of type `T`.
pub fn generate<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(tidy));
    let generator = settings.into_generator();
    generator.into_root_schema_for::<T>().to_value()
}

/// Takes out what serves no editor: null for a key that can as well be left out, and the line
/// breaks of descriptions.
fn tidy(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
    if schema.get("default").is_some_and(Value::is_null) {
        schema.remove("default");
    }
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(branches)) = schema.get_mut("anyOf") {
        branches.retain(|branch| branch["type"] != "null");
        if let [Value::Object(only)] = &mut branches[..] {
            let only = std::mem::take(only);
            schema.remove("anyOf");
            for (keyword, value) in only {
                let keywords = schema.ensure_object();
                keywords.entry(keyword).or_insert(value);
            }
        }
    }
}

/// Makes the tag of the first variant optional: it is the default.
pub(crate) fn default_variant(schema: &mut Schema) {
    if let Some(Value::Array(variants)) = schema.get_mut("oneOf")
        && let Some(Value::Array(required)) = variants.first_mut().map(|v| &mut v["required"])
        && !required.is_empty()
    {
        required.remove(0);
    }
}
