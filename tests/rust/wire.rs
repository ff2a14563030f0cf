// Calls everything of the wire layer that a user can call, so that the linker sees it all.

use icd::bootloader::procedures::{Download, Erase, Format, List, ProgramInformation, Upload};
use icd::common::enums::{FileType, FileUploadDestination};
use icd::wire::files::{IndexEntries, IndexEntry};
use icd::wire::procedure::{Procedure, Sink};
use icd::wire::{can, i2c, log, uart, Client, Crc, DosTime, Error, Event, Identity, Link, NodeEvent, NodeLink, Request, Table};

const LONGEST: usize = icd::cubeacp::LONGEST;
type Node = icd::cubeacp::Node;
type Uart = Client<Node, uart::Line<LONGEST>, 2>;
type I2c = Client<Node, i2c::Line<LONGEST>, 2>;
type Can = Client<Node, can::Line<LONGEST>, 2>;
type LinkOf = NodeLink<icd::cubeacp::Node>;
type Hear = fn(NodeEvent<'_, icd::cubeacp::Node>);

#[no_mangle] pub fn wire_checksum(link: &Link, name: &str, bytes: &[u8]) -> Result<u32, Error> { icd::wire::checksum(link, name, bytes) }
#[no_mangle] pub fn wire_crc(crc: &mut Crc<'_>, bytes: &[u8]) -> u32 { crc.feed(bytes); crc.result() }
#[no_mangle] pub fn wire_table(form: &icd::wire::link::CrcForm) -> Table { Table::new(form) }
#[no_mangle] pub fn wire_uart_encode(link: &Link, message: &[u8], out: &mut [u8]) -> Result<usize, Error> { uart::encode(link, message, out) }
#[no_mangle] pub fn wire_uart_kind(link: &Link, message: &[u8]) -> uart::Kind { uart::kind(link, message) }
#[no_mangle] pub fn wire_uart_decoder(link: &'static Link, to: &mut Option<uart::Decoder<LONGEST>>) { *to = uart::Decoder::new(link).ok(); }
#[no_mangle] pub fn wire_uart_feed(decoder: &mut uart::Decoder<LONGEST>, bytes: &[u8], hear: fn(uart::Event<'_>)) { decoder.feed(bytes, hear) }
#[no_mangle] pub fn wire_i2c_write(link: &Link, id: u8, data: &[u8], checked: bool, out: &mut [u8]) -> Result<usize, Error> { i2c::write(link, id, data, checked, out) }
#[no_mangle] pub fn wire_i2c_reply<'a>(link: &Link, id: u8, bytes: &'a [u8], checked: bool) -> Result<&'a [u8], Error> { i2c::reply(link, id, bytes, checked) }
#[no_mangle] pub fn wire_can_packet(id: u32, data: &[u8]) -> Option<can::Packet> { can::Packet::new(id, data) }
#[no_mangle] pub fn wire_can_split(link: &'static Link, message: &can::Message<'_>, each: fn(can::Packet)) -> Option<Error> { can::Splitter::new(link, message).map(|all| all.for_each(each)).err() }
#[no_mangle] pub fn wire_can_joiner(link: &'static Link, to: &mut Option<can::Joiner<LONGEST, 3>>) { *to = can::Joiner::new(link, None).ok(); }
#[no_mangle] pub fn wire_can_feed(joiner: &mut can::Joiner<LONGEST, 3>, now: u32, packet: &can::Packet, hear: fn(can::Event<'_>)) { joiner.feed(now, packet, hear) }
#[no_mangle] pub fn wire_can_expire(joiner: &mut can::Joiner<LONGEST, 3>, now: u32, hear: fn(can::Event<'_>)) { joiner.expire(now, hear) }
#[no_mangle] pub fn wire_log_feed(reader: &mut log::Reader<LONGEST>, bytes: &[u8], frame: fn(log::Frame<'_>)) { reader.feed(bytes, |entry| entry.frames().for_each(frame)) }
#[no_mangle] pub fn wire_log_reader(link: &'static Link, to: &mut Option<log::Reader<LONGEST>>) { *to = log::Reader::new(link).ok(); }
#[no_mangle] pub fn wire_log_write(link: &'static Link, mask: &[u8], frames: &[&[u8]], out: &mut [u8]) -> Result<usize, Error> { let writer = log::Writer::new(link, mask)?; writer.header(out)?; writer.entry(1, 2, frames, out) }
#[no_mangle] pub fn wire_log_message(link: &'static Link, bytes: &[u8], frame: fn(log::Frame<'_>)) -> Option<Error> { log::Message::decode(link, bytes).map(|one| one.frames().for_each(frame)).err() }
#[no_mangle] pub fn wire_log_encode(link: &'static Link, mask: &[u8], frames: &[&[u8]], out: &mut [u8]) -> Result<usize, Error> { log::Message::encode(link, mask, frames, out) }
#[no_mangle] pub fn wire_time(link: &Link, value: u32) -> Result<u32, Error> { DosTime::unpack(link, value)?.pack(link) }
#[no_mangle] pub fn wire_time_valid(time: &DosTime) -> bool { time.is_valid() }
#[no_mangle] pub fn wire_index(link: &'static Link, bytes: &[u8], each: fn(IndexEntry<'_>)) -> Result<usize, Error> { let entries = IndexEntries::new(link, bytes)?; let truncated = entries.truncated(); entries.for_each(each); Ok(truncated) }
#[no_mangle] pub fn wire_index_encode(entry: &IndexEntry<'_>, link: &Link, out: &mut [u8]) -> Result<usize, Error> { entry.encode(link, out) }
#[no_mangle] pub fn wire_identify(link: &Link, frame: &[u8]) -> Result<Identity, Error> { icd::wire::identify(link, frame) }

#[no_mangle] pub fn wire_client_uart(link: &'static LinkOf, to: &mut Option<Uart>) { *to = Uart::uart(link).ok().map(Uart::with_checksums); }
#[no_mangle] pub fn wire_client_i2c(link: &'static LinkOf, to: &mut Option<I2c>) { *to = Client::i2c(link).ok(); }
#[no_mangle] pub fn wire_client_can(link: &'static LinkOf, to: &mut Option<Can>) { *to = Client::can(link, 2).ok(); }
#[no_mangle] pub fn wire_client_start(client: &mut Uart, now: u32, request: &Request<'_>) -> Result<(), Error> { client.start(now, request) }
#[no_mangle] pub fn wire_client_request(client: &mut Uart, now: u32) -> Result<(), Error> { client.request::<icd::cubeacp::EstimatedAttitudeAngles>(now) }
#[no_mangle] pub fn wire_client_send(client: &mut Uart, now: u32, message: &icd::cubeacp::AdcsConfiguration) -> Result<(), Error> { client.send(now, message) }
#[no_mangle] pub fn wire_client_advance(client: &mut Uart, now: u32, procedure: &mut Procedure<'_, &'static mut dyn Sink>) -> Result<bool, Error> { client.advance(now, procedure) }
#[no_mangle] pub fn wire_client_output<'a>(client: &mut Uart, line: &'a mut [u8]) -> Result<Option<&'a [u8]>, Error> { client.output(line) }
#[no_mangle] pub fn wire_client_packet(client: &mut Can) -> Option<can::Packet> { client.output_packet() }
#[no_mangle] pub fn wire_client_transaction(client: &mut I2c) -> Option<i2c::Transaction<'_>> { client.output_transaction() }
#[no_mangle] pub fn wire_client_tick(client: &mut Uart, now: u32, hear: Hear) { client.tick(now, hear) }
#[no_mangle] pub fn wire_client_received(client: &mut Uart, now: u32, bytes: &[u8], hear: Hear) { client.received(now, bytes, hear) }
#[no_mangle] pub fn wire_client_joined(client: &mut Can, now: u32, packet: &can::Packet, hear: Hear) { client.packet(now, packet, hear) }
#[no_mangle] pub fn wire_client_transferred(client: &mut I2c, now: u32, bytes: Option<&[u8]>, hear: Hear) { client.transferred(now, bytes, hear) }

macro_rules! procedure {
    ($next:ident, $event:ident, $type:ty) => {
        #[no_mangle] pub fn $next<'a>(procedure: &'a mut $type, now: u32) -> Option<Request<'a>> { procedure.next(now) }
        #[no_mangle] pub fn $event(procedure: &mut $type, now: u32, event: &Event<'_>) { procedure.event(now, event) }
    };
}

type Block = fn(u32, &[u8]);
type Entry = fn(icd::common::FileInformation);
procedure!(wire_list_next, wire_list_event, List<Entry>);
procedure!(wire_download_next, wire_download_event, Download<'static, Block>);
procedure!(wire_upload_next, wire_upload_event, Upload<'static>);
procedure!(wire_erase_next, wire_erase_event, Erase);
procedure!(wire_format_next, wire_format_event, Format);
#[no_mangle] pub fn wire_list(entry: Entry, to: &mut Option<List<Entry>>) { *to = List::new(entry).ok(); }
#[no_mangle] pub fn wire_download(memory: &'static mut [u8], block: Block, to: &mut Option<Download<'static, Block>>) { *to = Download::new(FileType::from(15), 0, None, memory, block).ok(); }
#[no_mangle] pub fn wire_upload(data: &'static [u8], memory: &'static mut [u8], to: &mut Option<Upload<'static>>) { *to = Upload::new(FileUploadDestination::from(3), data, memory).ok(); if let Some(one) = to { one.set_block(99) } }
#[no_mangle] pub fn wire_information(procedure: &ProgramInformation) -> (Option<u32>, Option<u32>) { (procedure.size(), procedure.checksum()) }
