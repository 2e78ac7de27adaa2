//! The numbers of an array, whatever it is made of.

use hdf5_reader::error::Result;
use hdf5_reader::messages::datatype::Datatype;
use hdf5_reader::{Dataset, H5Type, SliceInfo};

/// The number that an array is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// That of a type of HDF5; none of what is no real number of a common size.
    pub(super) fn from_datatype(datatype: &Datatype) -> Option<Self> {
        Some(match datatype {
            Datatype::FloatingPoint { size: 4, .. } => Self::F32,
            Datatype::FloatingPoint { size: 8, .. } => Self::F64,
            Datatype::FixedPoint { size, signed, .. } => match (size, signed) {
                (1, true) => Self::I8,
                (1, false) => Self::U8,
                (2, true) => Self::I16,
                (2, false) => Self::U16,
                (4, true) => Self::I32,
                (4, false) => Self::U32,
                (8, true) => Self::I64,
                (8, false) => Self::U64,
                _ => return None,
            },
            _ => return None,
        })
    }
}

/// The numbers of a selection, row by row.
pub(super) fn numbers(
    dataset: &Dataset,
    number: Number,
    selection: &SliceInfo,
) -> Result<Vec<f64>> {
    fn read_as<T: H5Type + Copy>(
        dataset: &Dataset,
        selection: &SliceInfo,
        real: impl Fn(T) -> f64,
    ) -> Result<Vec<f64>> {
        let read = dataset.read_slice::<T>(selection)?;
        Ok(read.iter().map(|x| real(*x)).collect())
    }
    match number {
        Number::I8 => read_as::<i8>(dataset, selection, f64::from),
        Number::U8 => read_as::<u8>(dataset, selection, f64::from),
        Number::I16 => read_as::<i16>(dataset, selection, f64::from),
        Number::U16 => read_as::<u16>(dataset, selection, f64::from),
        Number::I32 => read_as::<i32>(dataset, selection, f64::from),
        Number::U32 => read_as::<u32>(dataset, selection, f64::from),
        Number::I64 => read_as::<i64>(dataset, selection, |x| x as f64),
        Number::U64 => read_as::<u64>(dataset, selection, |x| x as f64),
        Number::F32 => read_as::<f32>(dataset, selection, f64::from),
        Number::F64 => read_as::<f64>(dataset, selection, |x| x),
    }
}
