//! CRCs: streaming, without a table or with one.

use super::link::CrcForm;

/// State of a CRC that is computed piece by piece.
///
/// ```
/// use icdgen_runtime::wire::link::CrcForm;
/// use icdgen_runtime::wire::Crc;
///
/// let form = CrcForm {
///     width: 16,
///     polynomial: 0x1021,
///     init: 0,
///     reflect_in: false,
///     reflect_out: false,
///     xor_out: 0,
///     empty: None,
/// };
/// let mut crc = Crc::new(&form);
/// crc.feed(b"1234");
/// crc.feed(b"56789");
/// assert_eq!(crc.result(), 0x31c3);
/// ```
#[derive(Clone, Debug)]
pub struct Crc<'a> {
    form: &'a CrcForm,
    table: Option<&'a Table>,
    register: u32, // its highest bits hold the CRC
    fed: bool,
}

/// Lookup table for a fast CRC: 1 KiB, which may be a `static`.
///
/// ```
/// use icdgen_runtime::wire::link::CrcForm;
/// use icdgen_runtime::wire::{Crc, Table};
///
/// static FORM: CrcForm = CrcForm {
///     width: 8,
///     polynomial: 0x07,
///     init: 0,
///     reflect_in: false,
///     reflect_out: false,
///     xor_out: 0,
///     empty: None,
/// };
/// static TABLE: Table = Table::new(&FORM);
///
/// let mut crc = Crc::with_table(&FORM, &TABLE);
/// crc.feed(b"123456789");
/// assert_eq!(crc.result(), 0xf4);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table(Rows);

/// The registers after a byte, whose highest bits hold the CRC, for registers that were 0.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Rows {
    /// A CRC of up to 16 bits: the registers after the byte, and after one more byte, which is 0.
    /// Nothing of a register is left after two bytes, so that they are looked up at once.
    Narrow([u16; 256], [u16; 256]),
    Wide([u32; 256]),
}

impl Table {
    /// Compute the table of a CRC.
    #[must_use]
    pub const fn new(form: &CrcForm) -> Self {
        let polynomial = form.aligned_polynomial();
        let mut rows = [0; 256];
        let mut after_one = [0; 256];
        let mut after_two = [0; 256];
        let mut row = 0;
        let mut first: u32 = 0;
        while row < 256 {
            rows[row] = shifted(first, polynomial);
            after_one[row] = upper_half(rows[row]);
            after_two[row] = upper_half(shifted(rows[row], polynomial));
            row += 1;
            first = first.wrapping_add(1 << 24);
        }
        Self(if form.width <= 16 {
            Rows::Narrow(after_one, after_two)
        } else {
            Rows::Wide(rows)
        })
    }
}

const fn upper_half(register: u32) -> u16 {
    let [first, second, ..] = register.to_be_bytes();
    u16::from_be_bytes([first, second])
}

/// A register after eight bits.
const fn shifted(register: u32, polynomial: u32) -> u32 {
    let mut value = register;
    let mut bit = 0;
    while bit < 8 {
        value = (value << 1) ^ if value >> 31 == 0 { 0 } else { polynomial };
        bit += 1;
    }
    value
}

impl<'a> Crc<'a> {
    /// Create a CRC that is computed bit by bit.
    #[must_use]
    pub const fn new(form: &'a CrcForm) -> Self {
        Self::with(form, None)
    }

    /// Create a CRC that is computed with the [`Table`] of the same form.
    #[must_use]
    pub const fn with_table(form: &'a CrcForm, table: &'a Table) -> Self {
        Self::with(form, Some(table))
    }

    /// A CRC with a table if there is one.
    pub(super) const fn with(form: &'a CrcForm, table: Option<&'a Table>) -> Self {
        Self {
            form,
            table,
            register: form.init.wrapping_shl(form.unused_bits()),
            fed: false,
        }
    }

    /// Takes the next bytes.
    pub fn feed(&mut self, bytes: &[u8]) {
        self.fed = self.fed || !bytes.is_empty();
        self.register = if self.form.reflect_in {
            self.after(bytes, u8::reverse_bits)
        } else {
            self.after(bytes, |byte| byte)
        };
    }

    /// Return the register after these bytes, whose bits `order` puts in order.
    fn after(&self, bytes: &[u8], order: impl Fn(u8) -> u8) -> u32 {
        match self.table {
            Some(Table(Rows::Narrow(after_one, after_two))) => {
                let [mut first, mut second, ..] = self.register.to_be_bytes();
                let mut pairs = bytes.chunks_exact(2);
                for pair in &mut pairs {
                    if let [byte, next] = *pair {
                        let one = after_one[usize::from(second ^ order(next))];
                        let two = after_two[usize::from(first ^ order(byte))];
                        [first, second] = (one ^ two).to_be_bytes();
                    }
                }
                if let [byte] = *pairs.remainder() {
                    let [left, right] = after_one[usize::from(first ^ order(byte))].to_be_bytes();
                    [first, second] = [second ^ left, right];
                }
                u32::from_be_bytes([first, second, 0, 0])
            }
            Some(Table(Rows::Wide(rows))) => bytes.iter().fold(self.register, |register, byte| {
                let [first, ..] = register.to_be_bytes();
                (register << 8) ^ rows[usize::from(first ^ order(*byte))]
            }),
            None => {
                let polynomial = self.form.aligned_polynomial();
                bytes.iter().fold(self.register, |register, byte| {
                    shifted(register ^ (u32::from(order(*byte)) << 24), polynomial)
                })
            }
        }
    }

    /// Return the CRC of all bytes fed so far.
    #[must_use]
    pub const fn result(&self) -> u32 {
        if let (false, Some(value)) = (self.fed, self.form.empty) {
            return value;
        }
        let value = if self.form.reflect_out {
            self.register.reverse_bits()
        } else {
            self.register.wrapping_shr(self.form.unused_bits())
        };
        value ^ self.form.xor_out
    }
}
