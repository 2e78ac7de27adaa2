//! The licence of a dataset.

use schemars::JsonSchema;
use serde::Deserialize;

/// The licence under which a dataset may be used: its SPDX identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
pub enum Licence {
    /// No rights reserved.
    #[serde(rename = "CC0-1.0")]
    Cc0,
    /// Its authors are named.
    #[serde(rename = "CC-BY-4.0")]
    CcBy,
    /// Its authors are named, and what is made of it has the same licence.
    #[serde(rename = "CC-BY-SA-4.0")]
    CcBySa,
    /// Its authors are named, and nobody sells it.
    #[serde(rename = "CC-BY-NC-4.0")]
    CcByNc,
    /// Its authors are named, nobody sells it, and what is made of it has the same licence.
    #[serde(rename = "CC-BY-NC-SA-4.0")]
    CcByNcSa,
    /// Its authors are named, and it stays as it is.
    #[serde(rename = "CC-BY-ND-4.0")]
    CcByNd,
    /// Its authors are named, nobody sells it, and it stays as it is.
    #[serde(rename = "CC-BY-NC-ND-4.0")]
    CcByNcNd,
    /// The licence for data of the Linux Foundation, permissive.
    #[serde(rename = "CDLA-Permissive-2.0")]
    CdlaPermissive,
    /// The licence for data of the Linux Foundation that asks for the same of what is published.
    #[serde(rename = "CDLA-Sharing-1.0")]
    CdlaSharing,
    /// The licence for databases of Open Data Commons that asks for the same of what is made of it.
    #[serde(rename = "ODbL-1.0")]
    Odbl,
    /// The licence for databases of Open Data Commons, with the authors named.
    #[serde(rename = "ODC-By-1.0")]
    OdcBy,
    /// The public domain of Open Data Commons.
    #[serde(rename = "PDDL-1.0")]
    Pddl,
    /// That of the Massachusetts Institute of Technology.
    #[serde(rename = "MIT")]
    Mit,
    /// That of the Apache Software Foundation.
    #[serde(rename = "Apache-2.0")]
    Apache,
}

impl Licence {
    /// Its identifiers.
    pub fn identifiers(self) -> recordings::Licence {
        let new = recordings::Licence::new;
        match self {
            Self::Cc0 => recordings::Licence::CC0,
            Self::CcBy => new("CC-BY-4.0", "cc-by-4.0"),
            Self::CcBySa => new("CC-BY-SA-4.0", "cc-by-sa-4.0"),
            Self::CcByNc => new("CC-BY-NC-4.0", "cc-by-nc-4.0"),
            Self::CcByNcSa => new("CC-BY-NC-SA-4.0", "cc-by-nc-sa-4.0"),
            Self::CcByNd => new("CC-BY-ND-4.0", "cc-by-nd-4.0"),
            Self::CcByNcNd => new("CC-BY-NC-ND-4.0", "cc-by-nc-nd-4.0"),
            Self::CdlaPermissive => new("CDLA-Permissive-2.0", "cdla-permissive-2.0"),
            Self::CdlaSharing => new("CDLA-Sharing-1.0", "cdla-sharing-1.0"),
            Self::Odbl => new("ODbL-1.0", "odbl"),
            Self::OdcBy => new("ODC-By-1.0", "odc-by"),
            Self::Pddl => new("PDDL-1.0", "pddl"),
            Self::Mit => new("MIT", "mit"),
            Self::Apache => new("Apache-2.0", "apache-2.0"),
        }
    }
}
