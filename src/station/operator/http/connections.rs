//! The connections of a listener. A connection that waits only for its own client makes room for later
//! ones, so that a client that keeps connections open holds up no other.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;
use tokio::time::sleep;

/// The largest number of connections at a listener. Each takes some 20 kB.
const MOST: usize = 256;

/// The largest number for one address of the network: a browser has six and a stream. On this machine
/// all clients have the same address, so it does not tell them apart.
const MOST_OF_PEER: usize = 32;

/// How often to check whether a connection is still being served.
const LOOK: Duration = Duration::from_millis(10);

/// The connections of a listener.
#[derive(Debug, Default)]
pub struct Connections(Mutex<Inner>);

#[derive(Debug, Default)]
struct Inner {
    next: u64,
    /// By number, in the order of arrival.
    open: BTreeMap<u64, Entry>,
}

#[derive(Debug)]
struct Entry {
    peer: IpAddr,
    phase: Phase,
    close: Arc<Notify>,
}

/// What a connection waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Its client: the request is incomplete, or the answer is being sent.
    Idle,
    /// The station, which is working on the answer.
    Served,
    /// It lasts as long as the station.
    Stream,
}

/// One connection; it is registered until it is dropped.
#[derive(Debug)]
pub struct Connection {
    all: Arc<Connections>,
    number: u64,
    close: Arc<Notify>,
}

impl Connections {
    /// Admits a connection. If all places are taken, the oldest one that waits for its client is
    /// closed. Returns `None` if all are being served, or if this address has too many.
    pub fn admit(self: &Arc<Connections>, peer: IpAddr) -> Option<Arc<Connection>> {
        let mut inner = self.inner();
        let of_peer = || inner.open.values().filter(|entry| entry.peer == peer).count();
        if !peer.is_loopback() && of_peer() >= MOST_OF_PEER {
            return None;
        }
        if inner.open.len() >= MOST {
            let mut entries = inner.open.iter();
            let oldest = entries.find(|(_, entry)| entry.phase == Phase::Idle);
            let oldest = oldest.map(|(number, _)| *number)?;
            if let Some(entry) = inner.open.remove(&oldest) {
                entry.close.notify_one();
            }
        }
        let (number, close) = (inner.next, Arc::new(Notify::new()));
        inner.next += 1;
        let entry = Entry { peer, phase: Phase::Idle, close: Arc::clone(&close) };
        inner.open.insert(number, entry);
        Some(Arc::new(Connection { all: Arc::clone(self), number, close }))
    }

    /// Closes all connections that wait for their own clients.
    pub fn close_idle(&self) {
        for entry in self.inner().open.values().filter(|entry| entry.phase == Phase::Idle) {
            entry.close.notify_one();
        }
    }

    /// Returns when no connection waits for the station any more.
    pub async fn all_are_served(&self) {
        while self.inner().open.values().any(|entry| entry.phase == Phase::Served) {
            sleep(LOOK).await;
        }
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Connection {
    /// Returns when another connection needs the place.
    pub async fn must_close(&self) {
        self.close.notified().await;
    }

    /// Notes that the request is complete: the station works on its answer.
    pub fn is_served(&self) {
        self.turns(Phase::Served);
    }

    /// Notes that the answer is ready; it is sent as fast as the client reads it.
    pub fn is_answered(&self) {
        if !self.is_stream() {
            self.turns(Phase::Idle);
        }
    }

    /// Makes it a stream, which lasts as long as the station or its client.
    pub fn becomes_stream(&self) {
        self.turns(Phase::Stream);
    }

    /// Whether it has become a stream.
    pub fn is_stream(&self) -> bool {
        let inner = self.all.inner();
        inner.open.get(&self.number).is_some_and(|entry| entry.phase == Phase::Stream)
    }

    fn turns(&self, phase: Phase) {
        if let Some(entry) = self.all.inner().open.get_mut(&self.number) {
            entry.phase = phase;
        }
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.all.inner().open.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

    fn is_present(connection: &Connection) -> bool {
        connection.all.inner().open.contains_key(&connection.number)
    }

    #[test]
    fn where_all_places_are_taken_the_oldest_closes_that_waits_for_its_client() {
        let listener = Arc::new(Connections::default());
        let connections: Vec<_> = (0..MOST).map(|_| listener.admit(HERE).unwrap()).collect();
        connections[0].is_served();
        connections[1].becomes_stream();
        connections[1].is_answered();
        let later = listener.admit(HERE).unwrap();
        assert!(is_present(&later) && is_present(&connections[0]) && is_present(&connections[1]));
        assert!(!is_present(&connections[2]) && is_present(&connections[3]));
        connections[0].is_answered();
        listener.admit(HERE).unwrap();
        assert!(
            !is_present(&connections[0]),
            "its answer was there, and its client did not take it"
        );
    }

    #[test]
    fn where_all_are_served_none_is_admitted_and_a_closed_one_leaves_its_place() {
        let listener = Arc::new(Connections::default());
        let mut connections: Vec<_> = (0..MOST).map(|_| listener.admit(HERE).unwrap()).collect();
        connections.iter().for_each(|connection| connection.is_served());
        assert!(listener.admit(HERE).is_none());
        connections.pop();
        assert!(listener.admit(HERE).is_some());
    }

    #[test]
    fn an_address_of_the_network_has_its_share_and_no_more() {
        let listener = Arc::new(Connections::default());
        let peers: [IpAddr; 2] = ["192.168.1.20".parse().unwrap(), "192.168.1.21".parse().unwrap()];
        let connections: Vec<_> =
            (0..MOST_OF_PEER).map(|_| listener.admit(peers[0]).unwrap()).collect();
        assert!(listener.admit(peers[0]).is_none());
        assert!(listener.admit(peers[1]).is_some());
        drop(connections);
        assert!(listener.admit(peers[0]).is_some());
    }
}
