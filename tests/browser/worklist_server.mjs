// A server of a worklist (DICOM, C-FIND), whose entries change while it runs. What it sends is written by hand (PS3.7,
// PS3.8; Implicit VR Little Endian).

import { createServer } from "node:net";

const little = (size, value) => {
  const bytes = Buffer.alloc(size);
  bytes.writeUIntLE(value, 0, size);
  return bytes;
};
const big = (size, value) => little(size, value).reverse();

const packet = (kind, ...parts) => {
  const body = Buffer.concat(parts);
  return Buffer.concat([Buffer.from([kind, 0]), big(4, body.length), body]);
};
const item = (kind, ...parts) => {
  const body = Buffer.concat(parts);
  return Buffer.concat([Buffer.from([kind, 0]), big(2, body.length), body]);
};
// The whole of a command, 3, or of data, 2.
const message = (kind, ...parts) => {
  const body = Buffer.concat(parts);
  return packet(4, big(4, body.length + 2), Buffer.from([1, kind]), body);
};

const element = (group, number, value) => Buffer.concat([little(2, group), little(2, number), little(4, value.length), value]);
const text = (group, number, value) => {
  const bytes = Buffer.from(value, "utf8");
  return element(group, number, bytes.length % 2 ? Buffer.concat([bytes, Buffer.from(" ")]) : bytes);
};

const ACCEPTS = packet(2,
  Buffer.from([0, 1, 0, 0]), Buffer.from("RIS".padEnd(16) + "GAITER".padEnd(16)), Buffer.alloc(32),
  item(0x10, Buffer.from("1.2.840.10008.3.1.1.1")),
  item(0x21, Buffer.from([1, 0, 0, 0]), item(0x40, Buffer.from("1.2.840.10008.1.2"))),
  item(0x50, item(0x51, big(4, 16384))));
const RELEASED = packet(6, Buffer.alloc(4));

// The command of an answer: what it is to, whether data follows, and the status.
const command = (status, hasData) => {
  const numbers = [[0x0100, 0x8020], [0x0120, 1], [0x0800, hasData ? 1 : 0x0101], [0x0900, status]];
  return message(3, ...numbers.map(([number, value]) => element(0, number, little(2, value))));
};
const PENDING = command(0xff00, true);
const DONE = command(0, false);

// An entry for the station and the day that ask for it.
const dataSet = ({ patient, name, born, number, time }, day) => {
  const step = [
    text(0x0008, 0x0060, "OSS"), text(0x0040, 0x0001, "GAITER"), text(0x0040, 0x0002, day), text(0x0040, 0x0003, time),
    text(0x0040, 0x0009, "1"),
  ];
  return message(2,
    text(0x0008, 0x0005, "ISO_IR 192"), text(0x0008, 0x0050, number), text(0x0010, 0x0010, name), text(0x0010, 0x0020, patient),
    text(0x0010, 0x0030, born), text(0x0020, 0x000d, `1.2.276.${patient}`), text(0x0032, 0x1060, "Beinvermessung"),
    element(0x0040, 0x0100, element(0xfffe, 0xe000, Buffer.concat(step))));
};

// Scheduled Procedure Step Start Date of a query.
const DAY = Buffer.from([0x40, 0, 2, 0, 8, 0, 0, 0]);
const dayOf = (query) => {
  const from = query.indexOf(DAY) + DAY.length;
  return query.subarray(from, from + 8).toString("latin1");
};

export class WorklistServer {
  isAway = false;

  static async make(entries) {
    const server = new WorklistServer();
    server.entries = entries;
    server.listener = createServer((socket) => server.serve(socket));
    await new Promise((listens) => server.listener.listen(0, "127.0.0.1", listens));
    return server;
  }

  /** The section of a station that asks it. */
  get section() {
    const { port } = this.listener.address();
    return `[patient.worklist]\naddress = "127.0.0.1:${port}"\nserver_ae_title = "RIS"\nencryption = "none"\nevery = "10s"\n`;
  }

  end() {
    this.listener.close();
  }

  // One association. While it is away, connections end as soon as they are made.
  serve(socket) {
    socket.on("error", () => {});
    if (this.isAway) {
      socket.destroy();
      return;
    }
    let bytes = Buffer.alloc(0);
    socket.on("data", (more) => {
      bytes = Buffer.concat([bytes, more]);
      while (bytes.length >= 6 && bytes.length >= 6 + bytes.readUInt32BE(2)) {
        const length = 6 + bytes.readUInt32BE(2);
        this.answer(socket, bytes[0], bytes.subarray(6, length));
        bytes = bytes.subarray(length);
      }
    });
  }

  // The station sends a command in one packet, and the query in the next.
  answer(socket, kind, body) {
    if (kind === 1) {
      socket.write(ACCEPTS);
    } else if (kind !== 4) {
      socket.end(RELEASED);
    } else if ((body[5] & 1) === 0) {
      const entries = this.entries.flatMap((entry) => [PENDING, dataSet(entry, dayOf(body))]);
      socket.write(Buffer.concat([...entries, DONE]));
    }
  }
}
