//! The arrays of a file, and the numbers that it states beside them.

use super::numbers::{Number, numbers};
use super::packing::Packing;
use hdf5_reader::error::Result;
use hdf5_reader::group::Group;
use hdf5_reader::{Attribute, Dataset, Hdf5File, SliceInfo};
use std::collections::HashSet;

/// More channels than a matrix of samples has.
const MOST_CHANNELS: u64 = 256;

/// More groups within each other than anyone nests.
const DEEPEST: usize = 64;

/// Groups in which MATLAB keeps what no variable shows.
const HIDDEN: [&str; 2] = ["#refs#", "#subsystem#"];

/// A vector, or a matrix whose columns or rows are channels.
pub(super) struct Array {
    /// Path from the root, without a `/` before it.
    pub(super) path: String,
    pub(super) dataset: Dataset,
    pub(super) number: Number,
    pub(super) samples: u64,
    pub(super) channels: usize,
    /// The axis of the channels; none of a vector.
    pub(super) channel_axis: Option<usize>,
    pub(super) unit: Option<String>,
    /// How its numbers stand for its values, or why that is not understood.
    pub(super) packing: std::result::Result<Packing, String>,
}

/// A number beside the samples.
struct Stated {
    /// Path of the group or dataset that has it.
    place: String,
    name: String,
    value: f64,
}

/// What a file has.
pub(super) struct Contents {
    pub(super) arrays: Vec<Array>,
    stated: Vec<Stated>,
}

impl Contents {
    /// Those of a file.
    pub(super) fn read(file: &Hdf5File) -> Result<Self> {
        let mut contents = Self {
            arrays: Vec::new(),
            stated: Vec::new(),
        };
        let root = file.root_group()?;
        contents.add_group(&root, "", 0, &mut HashSet::from([root.address()]))?;
        Ok(contents)
    }

    /// Each group once, though links may lead to it from several.
    fn add_group(
        &mut self,
        group: &Group,
        path: &str,
        depth: usize,
        seen: &mut HashSet<u64>,
    ) -> Result<()> {
        let attributes = group.attributes()?;
        if attributes.iter().any(|a| a.name == "MATLAB_sparse") {
            return Ok(());
        }
        self.add_attributes(&attributes, path);
        let (groups, datasets) = group.members()?;
        for dataset in datasets {
            let inner = inside(path, dataset.name());
            self.add_dataset(dataset, path, inner)?;
        }
        for inner in groups {
            let is_hidden = HIDDEN.contains(&inner.name());
            if !is_hidden && depth < DEEPEST && seen.insert(inner.address()) {
                let path = inside(path, inner.name());
                self.add_group(&inner, &path, depth + 1, seen)?;
            }
        }
        Ok(())
    }

    fn add_attributes(&mut self, attributes: &[Attribute], place: &str) {
        for attribute in attributes {
            let is_one = matches!(attribute.num_elements(), Ok(1));
            if let (true, Ok(value)) = (is_one, attribute.read_as_f64()) {
                self.stated.push(Stated {
                    place: place.to_owned(),
                    name: attribute.name.clone(),
                    value,
                });
            }
        }
    }

    fn add_dataset(&mut self, dataset: Dataset, group: &str, path: String) -> Result<()> {
        let attributes = dataset.attributes();
        let Some(number) = Number::from_datatype(dataset.dtype()) else {
            return Ok(());
        };
        if is_no_number(&attributes) {
            return Ok(());
        }
        if dataset.shape().iter().all(|length| *length == 1) {
            let all = SliceInfo::all(dataset.ndim());
            let value = numbers(&dataset, number, &all)?;
            let Ok(packing) = Packing::of(&attributes) else {
                return Ok(());
            };
            self.stated.push(Stated {
                place: group.to_owned(),
                name: dataset.name().rsplit('/').next().unwrap_or_default().to_owned(),
                value: packing.value(value[0]),
            });
            return Ok(());
        }
        let (samples, channels, channel_axis) = match dataset.shape() {
            [samples] => (*samples, 1, None),
            [rows, columns] if rows >= columns => (*rows, *columns, Some(1)),
            [rows, columns] => (*columns, *rows, Some(0)),
            _ => return Ok(()),
        };
        if samples == 0 || !(1..=MOST_CHANNELS).contains(&channels) {
            return Ok(());
        }
        self.add_attributes(&attributes, &path);
        let unit = ["units", "unit"].iter().find_map(|name| text(&attributes, name));
        self.arrays.push(Array {
            path,
            dataset,
            number,
            samples,
            channels: channels as usize,
            channel_axis,
            unit,
            packing: Packing::of(&attributes),
        });
        Ok(())
    }

    /// The number called so that counts for the array at `path`: the nearest outwards, or else the only one that the file has.
    pub(super) fn stated(&self, path: &str, is_called: impl Fn(&str) -> bool) -> Option<f64> {
        if let Some((_, value)) = self.nearest(path, &is_called).first() {
            return Some(*value);
        }
        let called = self.stated.iter().filter(|stated| is_called(&stated.name));
        let mut values = called.map(|stated| stated.value);
        let first = values.next()?;
        values.all(|value| value == first).then_some(first)
    }
}

impl Contents {
    /// The numbers called so, by name, in the innermost place around the array at `path` that has any.
    pub(super) fn nearest(&self, path: &str, is_called: impl Fn(&str) -> bool) -> Vec<(&str, f64)> {
        let called = self.stated.iter().filter(|stated| is_called(&stated.name));
        let around = called.filter(|stated| {
            let rest = path.strip_prefix(stated.place.as_str());
            stated.place.is_empty() || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        });
        let around: Vec<&Stated> = around.collect();
        let innermost = around.iter().map(|stated| stated.place.len()).max();
        let nearest = around.iter().filter(|stated| Some(stated.place.len()) == innermost);
        nearest.map(|stated| (stated.name.as_str(), stated.value)).collect()
    }
}

/// The path of a member of a group.
fn inside(group: &str, name: &str) -> String {
    let name = name.rsplit('/').next().unwrap_or_default();
    match group {
        "" => name.to_owned(),
        group => format!("{group}/{name}"),
    }
}

/// Whether numbers stand for something else: MATLAB's text and empty arrays, and the axes of NetCDF that have no values.
fn is_no_number(attributes: &[Attribute]) -> bool {
    let class = text(attributes, "MATLAB_class");
    let is_numeric = |class: &str| {
        ["double", "single"].contains(&class) || class.trim_start_matches('u').starts_with("int")
    };
    let is_axis = |name: String| name.starts_with("This is a netCDF dimension but not a netCDF variable");
    class.is_some_and(|class| !is_numeric(&class))
        || attributes.iter().any(|a| a.name == "MATLAB_empty")
        || text(attributes, "NAME").is_some_and(is_axis)
}

/// An attribute that is one text, without the zeros and blanks around it; none where it is empty.
fn text(attributes: &[Attribute], name: &str) -> Option<String> {
    let attribute = attributes.iter().find(|a| a.name == name)?;
    let value = attribute.read_string().ok()?;
    let value = value.trim_matches(|c: char| c == '\0' || c.is_whitespace());
    (!value.is_empty()).then(|| value.to_owned())
}
