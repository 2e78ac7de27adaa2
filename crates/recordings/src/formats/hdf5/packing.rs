//! How the numbers of an array stand for its values: the attributes that NetCDF has for packed data (NetCDF Users Guide,
//! appendix A, Attribute Conventions).

use hdf5_reader::Attribute;

/// How the numbers of an array stand for its values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Packing {
    scale: f64,
    offset: f64,
    /// Numbers that stand for no value.
    missing: Vec<f64>,
}

impl Packing {
    /// That of these attributes.
    ///
    /// # Errors
    /// Attributes that are not understood, as a reason.
    pub(super) fn of(attributes: &[Attribute]) -> Result<Self, String> {
        if attributes
            .iter()
            .any(|attribute| attribute.name == "_Unsigned")
        {
            return Err("the attribute `_Unsigned` is not understood".to_owned());
        }
        let mut missing = Vec::new();
        for name in ["_FillValue", "missing_value"] {
            missing.extend(number(attributes, name)?);
        }
        let scale = number(attributes, "scale_factor")?.unwrap_or(1.0);
        let offset = number(attributes, "add_offset")?.unwrap_or(0.0);
        if !(scale.is_finite() && scale != 0.0 && offset.is_finite()) {
            return Err(format!(
                "`scale_factor` is {scale} and `add_offset` is {offset}"
            ));
        }
        Ok(Self {
            scale,
            offset,
            missing,
        })
    }

    /// The value that a number stands for: number × scale + offset; NaN where it is missing.
    pub(super) fn value(&self, number: f64) -> f64 {
        match self.missing.contains(&number) {
            true => f64::NAN,
            false => number * self.scale + self.offset,
        }
    }
}

/// The number in an attribute; none where there is no such attribute.
fn number(attributes: &[Attribute], name: &str) -> Result<Option<f64>, String> {
    let Some(attribute) = attributes.iter().find(|attribute| attribute.name == name) else {
        return Ok(None);
    };
    match (attribute.num_elements(), attribute.read_as_f64()) {
        (Ok(1), Ok(number)) => Ok(Some(number)),
        _ => Err(format!("the attribute `{name}` is not one number")),
    }
}
