//! Columns of every width that Arrow has, as tables have them.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type,
    Int32Type, Int64Type, TimestampMicrosecondType, TimestampMillisecondType,
    TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef};
use arrow_schema::{DataType, TimeUnit};

/// Whole numbers; points in time in their unit since 1970.
///
/// # Errors
/// A number above 2^63 - 1, or an array of something else.
pub(super) fn integers(array: &dyn Array) -> Result<Vec<Option<i64>>, String> {
    match array.data_type() {
        DataType::Int8 => whole::<Int8Type>(array),
        DataType::Int16 => whole::<Int16Type>(array),
        DataType::Int32 => whole::<Int32Type>(array),
        DataType::Int64 => whole::<Int64Type>(array),
        DataType::UInt8 => whole::<UInt8Type>(array),
        DataType::UInt16 => whole::<UInt16Type>(array),
        DataType::UInt32 => whole::<UInt32Type>(array),
        DataType::UInt64 => whole::<UInt64Type>(array),
        DataType::Timestamp(TimeUnit::Second, _) => whole::<TimestampSecondType>(array),
        DataType::Timestamp(TimeUnit::Millisecond, _) => whole::<TimestampMillisecondType>(array),
        DataType::Timestamp(TimeUnit::Microsecond, _) => whole::<TimestampMicrosecondType>(array),
        DataType::Timestamp(TimeUnit::Nanosecond, _) => whole::<TimestampNanosecondType>(array),
        DataType::Dictionary(..) => looked_up(array, integers),
        other => Err(format!("{other} where whole numbers were announced")),
    }
}

fn whole<T: ArrowPrimitiveType>(array: &dyn Array) -> Result<Vec<Option<i64>>, String>
where
    T::Native: TryInto<i64>,
{
    let numbers = array.as_primitive::<T>().iter();
    let numbers = numbers.map(|number| number.map(TryInto::try_into).transpose());
    let numbers = numbers.collect::<Result<_, _>>();
    numbers.map_err(|_| "a whole number above 2^63 - 1".to_owned())
}

/// Real numbers.
///
/// # Errors
/// An array of something else.
pub(super) fn reals(array: &dyn Array) -> Result<Vec<Option<f64>>, String> {
    match array.data_type() {
        DataType::Float16 => Ok(real::<Float16Type>(array)),
        DataType::Float32 => Ok(real::<Float32Type>(array)),
        DataType::Float64 => Ok(real::<Float64Type>(array)),
        DataType::Decimal128(_, decimals) => {
            let one = 10_f64.powi(i32::from(*decimals));
            let numbers = array.as_primitive::<Decimal128Type>().iter();
            Ok(numbers.map(|number| number.map(|whole| whole as f64 / one)).collect())
        }
        DataType::Dictionary(..) => looked_up(array, reals),
        other => Err(format!("{other} where real numbers were announced")),
    }
}

/// The values of an array that a dictionary holds once, as `values` reads those of the dictionary.
fn looked_up<T: Clone>(
    array: &dyn Array,
    values: impl Fn(&dyn Array) -> Result<Vec<Option<T>>, String>,
) -> Result<Vec<Option<T>>, String> {
    let dictionary = array.as_any_dictionary();
    let values = values(dictionary.values())?;
    let keys = integers(dictionary.keys())?.into_iter();
    let value = |key: i64| values.get(usize::try_from(key).ok()?).cloned().flatten();
    Ok(keys.map(|key| key.and_then(value)).collect())
}

fn real<T: ArrowPrimitiveType>(array: &dyn Array) -> Vec<Option<f64>>
where
    T::Native: Into<f64>,
{
    let numbers = array.as_primitive::<T>().iter();
    numbers.map(|number| number.map(Into::into)).collect()
}

/// Texts, also those that a dictionary holds once.
///
/// # Errors
/// An array of something else.
pub(super) fn texts(array: &dyn Array) -> Result<Vec<Option<String>>, String> {
    let owned = |text: Option<&str>| text.map(str::to_owned);
    match array.data_type() {
        DataType::Utf8 => Ok(array.as_string::<i32>().iter().map(owned).collect()),
        DataType::LargeUtf8 => Ok(array.as_string::<i64>().iter().map(owned).collect()),
        DataType::Utf8View => Ok(array.as_string_view().iter().map(owned).collect()),
        DataType::Dictionary(..) => looked_up(array, texts),
        other => Err(format!("{other} where texts were announced")),
    }
}

/// Lists of real numbers, rounded to float32.
///
/// # Errors
/// A list with a missing number, or an array of something else.
pub(super) fn samples(array: &dyn Array) -> Result<Vec<Option<Vec<f32>>>, String> {
    match array.data_type() {
        DataType::List(_) => array.as_list::<i32>().iter().map(list).collect(),
        DataType::LargeList(_) => array.as_list::<i64>().iter().map(list).collect(),
        other => Err(format!("{other} where lists were announced")),
    }
}

fn list(list: Option<ArrayRef>) -> Result<Option<Vec<f32>>, String> {
    let Some(list) = list else {
        return Ok(None);
    };
    if list.null_count() > 0 {
        return Err("a list with a missing sample".to_owned());
    }
    match list.data_type() {
        DataType::Float32 => Ok(Some(list.as_primitive::<Float32Type>().values().to_vec())),
        DataType::Float64 => {
            let values = list.as_primitive::<Float64Type>().values().iter();
            Ok(Some(values.map(|x| *x as f32).collect()))
        }
        other => Err(format!("lists of {other} where real numbers were announced")),
    }
}
