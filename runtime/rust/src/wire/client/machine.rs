//! The requests of a client, and the responses that may still arrive after their end.

use super::awaited::{Awaited, Needed, Owed};
use super::line::{Arrival, Buffer, Plan, Sent};
use crate::wire::bits::{head, reached};
use crate::wire::link::{Link, NumberPlace, Response, Settings, StreamRow, Verdict, MOST_AWAITED};
use crate::wire::{Direction, Error, Event, Request};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// To be sent.
    Queued,
    /// Nothing responds to it.
    Sent,
    /// For a response, or the result of its transaction.
    Wait,
    /// Before it is sent to a busy device again, or before the next transaction.
    Pause,
}

/// Room for a request.
#[derive(Clone, Copy, Debug)]
struct Slot<B> {
    state: State,
    number: u32, // of the request, in the order of their beginning
    direction: Direction,
    id: u32,
    sent: Sent,
    data: B,
    length: usize,
    repeats: bool,    // whether it may be sent again after a time-out
    is_checked: bool, // whether it has a checksum that the device can find wrong
    awaited: Awaited,
    timeout: u32,
    attempts: u16,
    until: u32,  // end of the state
    latest: u32, // until when a response is in time
    limit: u32,  // until when progress extends `latest`
    missing: Needed,
    owed: Owed,
    transmission: Option<u32>, // the last one, while its result is missing
    is_polled: bool,           // it was transmitted, and its response is polled
    poll_end: Option<u32>,     // end of polling, or of transmitting it again
}

impl<B: Buffer> Slot<B> {
    const EMPTY: Self = Self {
        state: State::Idle,
        number: 0,
        direction: Direction::Telecommand,
        id: 0,
        sent: Sent::Telecommand(0),
        data: B::EMPTY,
        length: 0,
        repeats: false,
        is_checked: false,
        awaited: Awaited::NOTHING,
        timeout: 0,
        attempts: 0,
        until: 0,
        latest: 0,
        limit: 0,
        missing: Needed::NONE,
        owed: Owed::NONE,
        transmission: None,
        is_polled: false,
        poll_end: None,
    };

    /// Whether its state ends by itself.
    fn is_timed(&self) -> bool {
        !matches!(self.state, State::Idle | State::Queued)
    }

    /// Whether a response may arrive, also to an earlier attempt.
    fn is_awaited(&self) -> bool {
        self.state == State::Wait || self.owed != Owed::NONE
    }

    /// Whether the device handles it.
    fn is_in_flight(&self) -> bool {
        self.is_polled || matches!(self.state, State::Wait | State::Pause)
    }

    /// Return what is sent next.
    fn next(&self) -> (Sent, &[u8]) {
        match self.awaited.exchange.poll {
            Some(poll) if self.is_polled => (Sent::Request(poll.telemetry), &[]),
            _ => (self.sent, head(self.data.as_ref(), self.length)),
        }
    }
}

/// Responses that may still arrive although their request has ended.
#[derive(Clone, Copy, Debug)]
struct Late {
    awaited: Awaited,
    owed: Owed,
    until: u32,
}

/// The requests of a client.
#[derive(Clone, Debug)]
pub struct Machine<B, const R: usize> {
    pub(super) settings: Settings,
    pub(super) link: &'static Link,
    /// Whether each transmission has a result.
    pub(super) has_results: bool,
    requests: [Slot<B>; R],
    late: [Option<Late>; MOST_AWAITED],
    begun: u32,                           // number of requests
    transmissions: u32,                   // number of them
    begun_output: Option<(usize, usize)>, // request of which only some packets were taken; how many
    now: u32,                             // time of the last call
    gap_end: Option<u32>,
}

impl<B: Buffer, const R: usize> Machine<B, R> {
    pub(super) const fn new(link: &'static Link, has_results: bool) -> Self {
        Self {
            settings: link.client,
            link,
            has_results,
            requests: [Slot::EMPTY; R],
            late: [None; MOST_AWAITED],
            begun: 0,
            transmissions: 0,
            begun_output: None,
            now: 0,
            gap_end: None,
        }
    }

    pub(super) fn deadline(&self) -> Option<u32> {
        let timed = (0..R).filter(|place| self.is_timed(*place));
        let ends = timed.filter_map(|place| self.requests.get(place));
        let ends = ends.map(|slot| slot.until);
        let queued = self.oldest(|slot| slot.state == State::Queued);
        // It may be possible to send the request then.
        let late = queued.into_iter().flat_map(|place| self.blocking(place));
        let chances = self.gap_end.filter(|_| queued.is_some());
        let chances = chances.into_iter().chain(late.map(|late| late.until));
        let chances = chances.filter(|end| !reached(self.now, *end));
        ends.chain(chances).reduce(earlier)
    }

    pub(super) fn is_full(&self) -> bool {
        self.requests.iter().all(|slot| slot.state != State::Idle)
    }

    pub(super) fn start(
        &mut self,
        now: u32,
        request: &Request<'_>,
        plan: Plan,
    ) -> Result<(), Error> {
        let asks = request.direction == Direction::Telemetry;
        let mut slots = self.requests.iter_mut();
        let free = slots.find(|slot| slot.state == State::Idle);
        let slot = free.ok_or(Error::Busy)?;
        let (least, most) = plan.lengths;
        let length = if asks { least } else { request.data.len() };
        let expected = length.max(least).min(most); // `clamp` can panic
        let room = slot.data.as_mut().get_mut(..length);
        let data = room.filter(|_| length == expected).ok_or(Error::Length {
            expected,
            actual: length,
        })?;
        if asks {
            data.fill(0);
        } else {
            // `copy_from_slice` leaves a panic where a compiler does not see the equal lengths.
            for (to, from) in data.iter_mut().zip(request.data) {
                *to = *from;
            }
        }
        let mut awaited = plan.awaited;
        awaited.set_data(data);
        let timeout = awaited.exchange.timeout_ms;
        *slot = Slot {
            state: State::Queued,
            number: self.begun,
            direction: request.direction,
            id: request.id,
            sent: plan.sent,
            length,
            repeats: asks || request.repeat || plan.repeats,
            is_checked: plan.is_checked,
            awaited,
            timeout: match timeout {
                0 => self.settings.reply_timeout_ms,
                _ => timeout,
            },
            data: slot.data,
            ..Slot::EMPTY
        };
        self.begun = self.begun.wrapping_add(1);
        self.set_time(now);
        Ok(())
    }

    /// Store the time, and drop responses that can no longer arrive.
    pub(super) fn set_time(&mut self, now: u32) {
        self.now = now;
        self.gap_end = self.gap_end.filter(|end| !reached(now, *end));
        for late in &mut self.late {
            *late = late.filter(|late| !reached(now, late.until));
        }
    }

    /// Return the place of the oldest request with this property.
    fn oldest(&self, property: impl Fn(&Slot<B>) -> bool) -> Option<usize> {
        let slots = self.requests.iter().enumerate();
        let such = slots.filter(|(_, slot)| property(slot));
        let oldest = such.max_by_key(|(_, slot)| self.begun.wrapping_sub(slot.number));
        oldest.map(|(place, _)| place)
    }

    /// Encode the next message to send by `put`, which returns what the application takes, and the
    /// header.
    pub(super) fn output<U, H: AsRef<[u8]>>(
        &mut self,
        put: impl FnOnce(Sent, &[u8]) -> Result<(U, H), Error>,
    ) -> Result<Option<U>, Error> {
        let place = self.oldest(|slot| slot.state == State::Queued);
        let sent = place.filter(|place| self.may_be_sent(*place));
        let slot = match sent.and_then(|place| self.requests.get_mut(place)) {
            Some(slot) => slot,
            None => return Ok(None),
        };
        let (sent, data) = slot.next();
        let (output, header) = put(sent, data)?;
        let now = self.now;
        slot.transmission = Some(self.transmissions);
        slot.state = State::Wait;
        slot.until = now.wrapping_add(slot.timeout);
        if !slot.is_polled {
            slot.awaited.set_header(header.as_ref());
            slot.attempts = slot.attempts.saturating_add(1);
            slot.missing = slot.awaited.needed();
            slot.latest = slot.until;
            slot.limit = now.wrapping_add(self.settings.progress_for_ms);
            slot.poll_end = None;
            if !self.has_results {
                slot.owed.add(slot.missing);
                if slot.missing == Needed::NONE {
                    slot.state = State::Sent;
                    slot.until = now;
                }
            }
        }
        self.transmissions = self.transmissions.wrapping_add(1);
        self.gap_end = Some(now.wrapping_add(self.settings.gap_ms));
        Ok(Some(output))
    }

    /// Encode the next packet to send by `put`, which gets its index among those of its message and
    /// returns whether more follow.
    pub(super) fn output_piece<U>(
        &mut self,
        mut put: impl FnMut(Sent, &[u8], usize) -> Result<(U, bool), Error>,
    ) -> Result<Option<U>, Error> {
        if let Some((place, taken)) = self.begun_output {
            let slot = self.requests.get(place).ok_or(Error::Unsupported)?;
            let (sent, data) = slot.next();
            let (piece, is_more) = put(sent, data, taken)?;
            self.begun_output = is_more.then_some((place, taken + 1));
            return Ok(Some(piece));
        }
        let place = self.oldest(|slot| slot.state == State::Queued);
        let output = self.output(|sent, data| Ok((put(sent, data, 0)?, [])))?;
        Ok(output.map(|(piece, is_more)| {
            self.begun_output = place.filter(|_| is_more).map(|place| (place, 1));
            piece
        }))
    }

    /// Return the responses to requests in progress, but for this one.
    fn unfinished(&self, place: usize) -> impl Iterator<Item = &Awaited> + Clone {
        // Also those that are to be sent again: otherwise one of these and this request could each
        // wait until the other has ended.
        let others = self.requests.iter().enumerate();
        let others =
            others.filter(move |(other, slot)| *other != place && slot.missing != Needed::NONE);
        others.map(|(_, slot)| &slot.awaited)
    }

    /// Return the late responses for which this request waits: those that could be taken for its own,
    /// and all if no more of them can be stored.
    fn blocking(&self, place: usize) -> impl Iterator<Item = &Late> {
        let slot = self.requests.get(place);
        let slot = slot.filter(|slot| !slot.awaited.is_empty() && !slot.is_polled);
        let late = self.late.iter().flatten();
        let is_full = self.unfinished(place).count() + late.clone().count() >= MOST_AWAITED;
        late.filter(move |late| {
            slot.map_or(false, |slot| is_full || slot.awaited.is_like(&late.awaited))
        })
    }

    /// Return whether the device handles the queued request now, and no response to another request
    /// could be taken for a response to it.
    fn may_be_sent(&self, place: usize) -> bool {
        let slot = match self.requests.get(place) {
            Some(slot) if self.gap_end.map_or(true, |end| reached(self.now, end)) => slot,
            _ => return false,
        };
        let others = self.requests.iter().enumerate();
        let others = others.filter(|(other, slot)| *other != place && slot.is_in_flight());
        let mut unfinished = self.unfinished(place);
        slot.awaited.is_empty()
            || slot.is_polled
            || others.count() < usize::from(self.settings.in_flight)
                && self.blocking(place).next().is_none()
                && unfinished.clone().count() < MOST_AWAITED
                && !unfinished.any(|other| slot.awaited.is_like(other))
    }

    /// Return whether the state of a request ends by itself. One to which nothing responds is sent
    /// when all its packets were taken.
    fn is_timed(&self, place: usize) -> bool {
        let is_begun = self.begun_output.map_or(false, |(begun, _)| begun == place);
        let slot = self.requests.get(place);
        slot.map_or(false, |slot| {
            slot.is_timed() && !(is_begun && slot.state == State::Sent)
        })
    }

    pub(super) fn tick(&mut self, now: u32, on_event: &mut dyn FnMut(Event<'_>)) {
        self.set_time(now);
        loop {
            let timed = (0..R).filter(|place| self.is_timed(*place));
            let slots = timed.filter_map(|place| Some((place, self.requests.get(place)?)));
            let expired = slots.filter(|(_, slot)| reached(now, slot.until));
            let oldest = expired.max_by_key(|(_, slot)| self.begun.wrapping_sub(slot.number));
            let place = match oldest {
                Some((place, _)) => place,
                None => return,
            };
            if let Some(event) = self.expire(place) {
                on_event(event);
            }
        }
    }

    /// End the state of a request whose time is up. Return the outcome, if it has one.
    fn expire(&mut self, place: usize) -> Option<Event<'static>> {
        let now = self.now;
        let slot = self.requests.get_mut(place)?;
        match slot.state {
            State::Sent => self.sent(place),
            State::Wait => self.unanswered(place),
            _ if slot.poll_end.map_or(false, |end| reached(now, end)) => self.timeout(place),
            _ => {
                slot.state = State::Queued;
                None
            }
        }
    }

    /// Process that a response is missing or unusable: poll or send again, or end the request.
    pub(super) fn unanswered(&mut self, place: usize) -> Option<Event<'static>> {
        let (now, settings) = (self.now, self.settings);
        let slot = self.requests.get_mut(place)?;
        let is_left = if slot.is_polled {
            slot.poll_end.map_or(false, |end| !reached(now, end))
        } else {
            slot.repeats && slot.attempts <= u16::from(settings.retries)
        };
        if !is_left {
            return self.timeout(place);
        }
        slot.transmission = None;
        slot.state = State::Queued;
        if self.has_results {
            // The bus may report a failure at once: give the node some time.
            slot.state = State::Pause;
            slot.until = now.wrapping_add(settings.poll_interval_ms);
            if !slot.is_polled {
                slot.poll_end = Some(now.wrapping_add(settings.poll_timeout_ms));
            }
        }
        self.drop_output(place);
        None
    }

    /// Return the request that waits for the result of a transmission.
    pub(super) fn waiting(&self, transmission: u32) -> Option<usize> {
        let mut slots = self.requests.iter();
        slots.position(|slot| slot.state == State::Wait && slot.transmission == Some(transmission))
    }

    /// Return the number of the next transmission.
    pub(super) const fn transmissions(&self) -> u32 {
        self.transmissions
    }

    /// Process that the application has taken a transmission that has a result.
    pub(super) fn taken(&mut self, transmission: u32) {
        let place = self.waiting(transmission);
        let slot = place.and_then(|place| self.requests.get_mut(place));
        let slot = slot.filter(|slot| !slot.is_polled && slot.awaited.exchange.poll.is_some());
        if let Some(slot) = slot {
            // Without polling, the result of the transaction is the response.
            slot.owed = Owed::NONE;
            slot.owed.add(slot.missing);
        }
    }

    /// Process that a transmission has failed.
    pub(super) fn failed(&mut self, place: usize) -> Option<Event<'static>> {
        let slot = self.requests.get_mut(place)?;
        if !slot.is_polled {
            slot.owed = Owed::NONE; // the node has not received it
        }
        self.unanswered(place)
    }

    /// Process that a telecommand was transmitted: poll its response if it has one.
    pub(super) fn written(&mut self, place: usize) -> Option<Event<'static>> {
        let end = self.now.wrapping_add(self.settings.poll_timeout_ms);
        let slot = self.requests.get_mut(place)?;
        if slot.missing == Needed::NONE {
            return self.sent(place);
        }
        slot.is_polled = true;
        slot.poll_end = Some(end);
        slot.latest = end;
        self.unanswered(place)
    }

    /// Process the telemetry that a transmission has read.
    pub(super) fn read<'a>(&mut self, place: usize, arrival: &Arrival<'a>) -> Option<Event<'a>> {
        let awaited = self.requests.get(place)?.awaited;
        let until = awaited.exchange.poll.map(|poll| poll.until);
        let is_unfinished = until.map_or(false, |until| until.get(arrival.head, arrival.data) == 0);
        match awaited.matching(arrival) {
            Some(response) if !is_unfinished => self.responded(place, response, arrival),
            _ => self.unanswered(place),
        }
    }

    fn sent(&mut self, place: usize) -> Option<Event<'static>> {
        let slot = self.requests.get(place)?;
        let (direction, id, attempts) = (slot.direction, slot.id, slot.attempts);
        self.end(place);
        Some(Event::Sent {
            direction,
            id,
            attempts,
        })
    }

    fn timeout(&mut self, place: usize) -> Option<Event<'static>> {
        let slot = self.requests.get(place)?;
        let (direction, id, attempts) = (slot.direction, slot.id, slot.attempts);
        self.end(place);
        Some(Event::Timeout {
            direction,
            id,
            attempts,
        })
    }

    /// Return the telemetry that may arrive in a packet without its id.
    pub(super) fn nameless(&self) -> impl Iterator<Item = &'static StreamRow> + Clone + '_ {
        let first = self.oldest(|slot| slot.is_awaited() && slot.awaited.nameless.is_some());
        let first = first.and_then(|place| self.requests.get(place));
        let first = first.and_then(|slot| slot.awaited.nameless);
        let late = self.late.iter().flatten();
        let late = late.filter_map(|late| late.awaited.nameless);
        first.into_iter().chain(late)
    }

    /// Return the event of what a line has received: that of an arrival, or an event that belongs to
    /// no request.
    pub(super) fn processed<'a>(
        &mut self,
        received: Result<Arrival<'a>, Event<'a>>,
    ) -> Option<Event<'a>> {
        match received {
            Ok(arrival) => self.arrived(&arrival),
            Err(event) => Some(event),
        }
    }

    /// Return what arrived: a response to a request, late, stray or unsolicited. None if its request
    /// is sent again.
    fn arrived<'a>(&mut self, arrival: &Arrival<'a>) -> Option<Event<'a>> {
        let is_response = |slot: &Slot<B>| slot.awaited.matching(arrival).is_some();
        let place = self.oldest(|slot| slot.is_awaited() && is_response(slot));
        let slot = place.and_then(|place| Some((place, self.requests.get(place)?)));
        let response =
            slot.and_then(|(place, slot)| Some((place, slot.awaited.matching(arrival)?)));
        if let Some((place, response)) = response {
            return self.responded(place, response, arrival);
        }
        for entry in &mut self.late {
            let response = entry
                .as_ref()
                .and_then(|late| late.awaited.matching(arrival));
            if let (Some(late), Some(response)) = (entry.as_mut(), response) {
                late.owed.remove(arrival.verdict(response));
                *entry = entry.filter(|late| late.owed != Owed::NONE);
                return Some(arrival.late());
            }
        }
        Some(arrival.unawaited())
    }

    /// Process a response to a request.
    fn responded<'a>(
        &mut self,
        place: usize,
        response: &Response,
        arrival: &Arrival<'a>,
    ) -> Option<Event<'a>> {
        let Arrival {
            id: reply,
            packet,
            data,
            values,
            ..
        } = *arrival;
        let (now, settings) = (self.now, self.settings);
        let slot = self.requests.get_mut(place)?;
        let verdict = arrival.verdict(response);
        let number = |place: NumberPlace| place.get(arrival.head, data);
        let (direction, id, attempts) = (slot.direction, slot.id, slot.attempts);
        let is_left = attempts <= u16::from(settings.retries);
        slot.owed.remove(verdict);
        match verdict {
            Verdict::Progress => {
                let extended = earlier(now.wrapping_add(slot.timeout), slot.limit);
                slot.latest = later(slot.latest, extended);
                if slot.state == State::Wait {
                    slot.until = slot.latest;
                }
            }
            Verdict::Busy if is_left => {
                slot.state = State::Pause;
                slot.until = now.wrapping_add(settings.busy_pause_ms);
            }
            // The device did not receive it as it was sent.
            Verdict::Again if is_left && slot.is_checked => {
                slot.state = State::Queued;
                slot.is_polled = false;
                self.drop_output(place);
                return None;
            }
            Verdict::Ack => slot.missing.ack = false,
            Verdict::Reply => slot.missing.reply = false,
            Verdict::Nak | Verdict::Busy | Verdict::Again => slot.missing = Needed::NONE,
        }
        let is_ended = slot.missing == Needed::NONE;
        if is_ended {
            self.end(place);
        }
        let code = response.reason.map(number);
        Some(match verdict {
            Verdict::Nak | Verdict::Again => Event::Refused {
                direction,
                id,
                attempts,
                code,
                may_be_damaged: code.map_or(false, |code| {
                    !self.link.reasons.is_empty() && !self.link.reasons.contains(&code)
                }),
                detail: response.detail.map(number),
                reply,
                packet,
                data,
            },
            Verdict::Busy if is_ended => Event::Busy {
                direction,
                id,
                attempts,
                code,
                reply,
                packet,
                data,
            },
            Verdict::Ack | Verdict::Reply if is_ended => Event::Done {
                direction,
                id,
                attempts,
                reply,
                packet,
                data,
                values,
            },
            Verdict::Reply => Event::Reply {
                direction,
                id,
                reply,
                data,
                values,
            },
            Verdict::Ack | Verdict::Busy | Verdict::Progress => Event::Progress {
                direction,
                id,
                reply,
                packet,
                data,
            },
        })
    }

    /// Do not send the remaining packets of a request.
    fn drop_output(&mut self, place: usize) {
        self.begun_output = self.begun_output.filter(|(begun, _)| *begun != place);
    }

    /// End a request, and remember the responses that may still arrive.
    fn end(&mut self, place: usize) {
        if let Some(slot) = self.requests.get_mut(place) {
            // A response counts from the transmission or from progress, not from the end.
            let until = slot.latest.wrapping_add(self.settings.late_ms);
            let mut entries = self.late.iter_mut();
            if slot.owed != Owed::NONE && !reached(self.now, until) {
                if let Some(free) = entries.find(|late| late.is_none()) {
                    *free = Some(Late {
                        awaited: slot.awaited,
                        owed: slot.owed,
                        until,
                    });
                }
            }
            slot.state = State::Idle;
            slot.is_polled = false;
            slot.missing = Needed::NONE;
            slot.owed = Owed::NONE;
        }
        self.drop_output(place);
    }

    /// Cancel the requests of a message; None: all.
    pub(super) fn cancel(&mut self, which: Option<(Direction, u32)>) {
        let is_meant = |slot: &Slot<B>| {
            slot.state != State::Idle && which.map_or(true, |it| it == (slot.direction, slot.id))
        };
        while let Some(place) = self.oldest(is_meant) {
            self.end(place);
        }
    }
}

fn earlier(time: u32, other: u32) -> u32 {
    if reached(time, other) {
        other
    } else {
        time
    }
}

fn later(time: u32, other: u32) -> u32 {
    if reached(time, other) {
        time
    } else {
        other
    }
}
