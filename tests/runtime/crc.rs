//! The CRC of the digits 1 to 9, in pieces of which some are empty, with a table and without; its parameters are the
//! arguments. The CRC of no bytes is another one.

use icdgen_runtime::wire::link::CrcForm;
use icdgen_runtime::wire::{Crc, Table};

fn main() {
    let given: Vec<u32> = std::env::args()
        .skip(1)
        .map(|argument| argument.parse().expect("a number"))
        .collect();
    let form = CrcForm {
        width: given[0],
        polynomial: given[1],
        init: given[2],
        reflect_in: given[3] == 1,
        reflect_out: given[4] == 1,
        xor_out: given[5],
        empty: Some(0xA5),
    };
    let table = Table::new(&form);
    let results = [Crc::new(&form), Crc::with_table(&form, &table)].map(|mut crc| {
        crc.feed(b"");
        assert_eq!(crc.result(), 0xA5);
        crc.feed(b"1234");
        crc.feed(b"56789");
        crc.feed(b"");
        crc.result()
    });
    assert_eq!(results[0], results[1]);
    println!("{}", results[0]);
}
