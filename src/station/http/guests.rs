//! Who is connected to a door. A connection that waits for nobody but its own client makes room for those
//! who come later, so that whoever holds connections open holds up nobody.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;
use tokio::time::sleep;

/// So many connections there are at a door at a time. Each takes some 20 kB.
const MOST: usize = 256;

/// So many of one address of the network: a browser has six and a stream. On this machine everybody has
/// the same address, and nothing tells people apart by it.
const MOST_OF_PEER: usize = 32;

/// How often it is looked whether anybody is still served.
const LOOK: Duration = Duration::from_millis(10);

/// The connections of a door.
#[derive(Debug, Default)]
pub struct Guests(Mutex<Inner>);

#[derive(Debug, Default)]
struct Inner {
    next: u64,
    /// By their numbers, in the order in which they came.
    present: BTreeMap<u64, Guest>,
}

#[derive(Debug)]
struct Guest {
    peer: IpAddr,
    phase: Phase,
    leave: Arc<Notify>,
}

/// What a connection waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Its client: the request is not whole, or the answer is on its way.
    Idle,
    /// The station, which works on the answer.
    Served,
    /// It lasts as long as the station.
    Stream,
}

/// One connection, there until it is dropped.
#[derive(Debug)]
pub struct Visit {
    guests: Arc<Guests>,
    number: u64,
    leave: Arc<Notify>,
}

impl Guests {
    /// Takes a connection in. Where the door is full the oldest that waits for its client goes; none
    /// where all are served, or where this address has too many.
    pub fn admit(self: &Arc<Guests>, peer: IpAddr) -> Option<Arc<Visit>> {
        let mut inner = self.inner();
        let of_peer = || inner.present.values().filter(|guest| guest.peer == peer).count();
        if !peer.is_loopback() && of_peer() >= MOST_OF_PEER {
            return None;
        }
        if inner.present.len() >= MOST {
            let mut guests = inner.present.iter();
            let oldest = guests.find(|(_, guest)| guest.phase == Phase::Idle);
            let oldest = oldest.map(|(number, _)| *number)?;
            if let Some(guest) = inner.present.remove(&oldest) {
                guest.leave.notify_one();
            }
        }
        let (number, leave) = (inner.next, Arc::new(Notify::new()));
        inner.next += 1;
        let guest = Guest { peer, phase: Phase::Idle, leave: Arc::clone(&leave) };
        inner.present.insert(number, guest);
        Some(Arc::new(Visit { guests: Arc::clone(self), number, leave }))
    }

    /// Sends away all who wait for their own clients.
    pub fn dismiss_idle(&self) {
        for guest in self.inner().present.values().filter(|guest| guest.phase == Phase::Idle) {
            guest.leave.notify_one();
        }
    }

    /// Ends when nobody waits for the station any more.
    pub async fn all_are_served(&self) {
        while self.inner().present.values().any(|guest| guest.phase == Phase::Served) {
            sleep(LOOK).await;
        }
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Visit {
    /// Ends when somebody else needs the place.
    pub async fn is_sent_away(&self) {
        self.leave.notified().await;
    }

    /// The request is whole: the station works on its answer.
    pub fn is_served(&self) {
        self.turns(Phase::Served);
    }

    /// The answer is there, and goes out as fast as its client takes it.
    pub fn is_answered(&self) {
        if !self.is_stream() {
            self.turns(Phase::Idle);
        }
    }

    /// It lasts as long as the station, or as its client.
    pub fn becomes_stream(&self) {
        self.turns(Phase::Stream);
    }

    /// Whether it has become a stream.
    pub fn is_stream(&self) -> bool {
        let inner = self.guests.inner();
        inner.present.get(&self.number).is_some_and(|guest| guest.phase == Phase::Stream)
    }

    fn turns(&self, phase: Phase) {
        if let Some(guest) = self.guests.inner().present.get_mut(&self.number) {
            guest.phase = phase;
        }
    }
}

impl Drop for Visit {
    fn drop(&mut self) {
        self.guests.inner().present.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

    fn is_present(visit: &Visit) -> bool {
        visit.guests.inner().present.contains_key(&visit.number)
    }

    #[test]
    fn at_a_full_door_the_oldest_goes_that_waits_for_its_client() {
        let door = Arc::new(Guests::default());
        let guests: Vec<_> = (0..MOST).map(|_| door.admit(HERE).unwrap()).collect();
        guests[0].is_served();
        guests[1].becomes_stream();
        guests[1].is_answered();
        let later = door.admit(HERE).unwrap();
        assert!(is_present(&later) && is_present(&guests[0]) && is_present(&guests[1]));
        assert!(!is_present(&guests[2]) && is_present(&guests[3]));
        guests[0].is_answered();
        door.admit(HERE).unwrap();
        assert!(!is_present(&guests[0]), "its answer was there, and its client did not take it");
    }

    #[test]
    fn where_everybody_is_served_nobody_comes_in_and_a_place_that_is_left_is_free() {
        let door = Arc::new(Guests::default());
        let mut guests: Vec<_> = (0..MOST).map(|_| door.admit(HERE).unwrap()).collect();
        guests.iter().for_each(|guest| guest.is_served());
        assert!(door.admit(HERE).is_none());
        guests.pop();
        assert!(door.admit(HERE).is_some());
    }

    #[test]
    fn an_address_of_the_network_has_its_share_and_no_more() {
        let door = Arc::new(Guests::default());
        let peers: [IpAddr; 2] = ["192.168.1.20".parse().unwrap(), "192.168.1.21".parse().unwrap()];
        let guests: Vec<_> = (0..MOST_OF_PEER).map(|_| door.admit(peers[0]).unwrap()).collect();
        assert!(door.admit(peers[0]).is_none());
        assert!(door.admit(peers[1]).is_some());
        drop(guests);
        assert!(door.admit(peers[0]).is_some());
    }
}
