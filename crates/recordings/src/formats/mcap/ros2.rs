//! Flat ROS 2 messages: their definition, and their bytes in CDR.
//!
//! A message is flat when its fields are numbers, and a time stamp or a header: `builtin_interfaces/Time`
//! and `std_msgs/Header`. Other messages are left alone.

/// A field of a flat message.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    /// What the comment behind it says; this program puts the unit there.
    pub(super) comment: Option<String>,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
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
    Time,
    Header,
}

impl Kind {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "int8" => Self::I8,
            "uint8" | "byte" | "char" | "bool" => Self::U8,
            "int16" => Self::I16,
            "uint16" => Self::U16,
            "int32" => Self::I32,
            "uint32" => Self::U32,
            "int64" => Self::I64,
            "uint64" => Self::U64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            "builtin_interfaces/Time" | "builtin_interfaces/Duration" => Self::Time,
            "std_msgs/Header" | "Header" => Self::Header,
            _ => return None,
        })
    }

    /// Bytes of a number; 0 for other types.
    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
            Self::Time | Self::Header => 0,
        }
    }
}

impl Field {
    /// Whether it is a real number, and so may be a channel.
    pub(super) fn is_real(&self) -> bool {
        matches!(self.kind, Kind::F32 | Kind::F64)
    }
}

/// The fields of a definition; none where it is not flat.
pub(super) fn fields(definition: &str) -> Option<Vec<Field>> {
    let mut fields = Vec::new();
    // The definitions of the parts follow behind a line of `=`.
    for line in definition
        .lines()
        .take_while(|line| !line.starts_with("==="))
    {
        let (code, comment) = match line.split_once('#') {
            Some((code, comment)) => (code, Some(comment.trim())),
            None => (line, None),
        };
        let mut words = code.split_whitespace();
        let Some(kind) = words.next() else { continue };
        let name = words.next()?;
        // A constant is no field.
        if code.contains('=') {
            continue;
        }
        fields.push(Field {
            name: name.to_owned(),
            comment: comment.filter(|c| !c.is_empty()).map(str::to_owned),
            kind: Kind::from_name(kind)?,
        });
    }
    Some(fields)
}

/// The numbers of a message, one per field (NaN for a time stamp or a header); none where it does
/// not have the bytes.
pub(super) fn decode(message: &[u8], fields: &[Field]) -> Option<Vec<f64>> {
    // Plain CDR: the second byte is 1 for little-endian numbers, 0 for big-endian ones.
    let (head, body) = message.split_at_checked(4)?;
    if head[0] != 0 || head[1] > 1 {
        return None;
    }
    let mut cursor = Cursor {
        body,
        at: 0,
        big_endian: head[1] == 0,
    };
    fields
        .iter()
        .map(|field| cursor.field(field.kind))
        .collect()
}

struct Cursor<'a> {
    body: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl Cursor<'_> {
    fn field(&mut self, kind: Kind) -> Option<f64> {
        match kind {
            Kind::Time => {
                self.word(4)?;
                self.word(4)?;
                return Some(f64::NAN);
            }
            Kind::Header => {
                self.word(4)?;
                self.word(4)?;
                let letters = self.word(4)?;
                self.at = self.at.checked_add(usize::try_from(letters).ok()?)?;
                return Some(f64::NAN);
            }
            _ => {}
        }
        let bits = self.word(kind.bytes())?;
        Some(match kind {
            Kind::I8 => f64::from(bits as i8),
            Kind::I16 => f64::from(bits as i16),
            Kind::I32 => f64::from(bits as i32),
            Kind::I64 => bits as i64 as f64,
            Kind::F32 => f64::from(f32::from_bits(bits as u32)),
            Kind::F64 => f64::from_bits(bits),
            _ => bits as f64,
        })
    }

    /// The next number of so many bytes, at a multiple of its size.
    fn word(&mut self, bytes: usize) -> Option<u64> {
        let from = self.at.checked_next_multiple_of(bytes)?;
        let mut word = [0; 8];
        word[..bytes].copy_from_slice(self.body.get(from..from.checked_add(bytes)?)?);
        if self.big_endian {
            word[..bytes].reverse();
        }
        self.at = from + bytes;
        Some(u64::from_le_bytes(word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_all_sizes_are_found_at_their_places() {
        let definition = "std_msgs/Header header\nuint8 MODE=3\nint8 a\nfloat64 b # m/s^2\nint16 c\n\nfloat32 d\n===\nMSG: std_msgs/Header\nstring frame_id";
        let fields = fields(definition).unwrap();
        let mut message = vec![0, 1, 0, 0];
        message.extend(1_i32.to_le_bytes());
        message.extend(2_u32.to_le_bytes());
        message.extend(3_u32.to_le_bytes());
        message.extend(b"ab\0");
        message.push((-5_i8) as u8); // a, at byte 15 of the body
        message.extend(2.5_f64.to_le_bytes()); // b, at 16
        message.extend((-300_i16).to_le_bytes()); // c, at 24
        message.extend([0, 0]); // d stands at a multiple of 4
        message.extend(0.25_f32.to_le_bytes());
        let numbers = decode(&message, &fields).unwrap();
        assert!(numbers[0].is_nan());
        assert_eq!(numbers[1..], [-5.0, 2.5, -300.0, 0.25]);
        assert_eq!(fields[2].comment.as_deref(), Some("m/s^2"));
        assert_eq!(decode(&message[..30], &fields), None);
        assert_eq!(super::fields("string name\nfloat32 x"), None);
        assert_eq!(super::fields("float32[] x"), None);
    }
}
