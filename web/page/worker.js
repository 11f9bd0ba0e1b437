// The worker: reads the files, runs the module, tells how far it is. It is ended by the page, which is how a replay is cancelled.
"use strict";
const MOST_BYTES = 512 * 2 ** 20, SLICE = 8 * 2 ** 20;
let module = null;

class Refused extends Error {}

const view = (at, bytes) => new Uint8Array(module.memory.buffer, at, bytes);
const out = () => view(module.out(), module.out_bytes());
const textOf = (bytes) => new TextDecoder().decode(bytes);

function room(bytes) {
  const at = module.reserve(bytes) >>> 0;
  if (at === 0) throw new Refused("The files need more memory than a page has; the command magcomp reads them.");
  return at;
}

function given(text) {
  const bytes = new TextEncoder().encode(text), at = room(bytes.length);
  view(at, bytes.length).set(bytes);
  return [at, bytes.length];
}

function checked(code) {
  if (code < 0) throw new Refused(textOf(out()));
  return code;
}

async function read(files) {
  const all = files.reduce((sum, file) => sum + file.size, 0);
  const megabytes = (bytes) => `${Math.ceil(bytes / 2 ** 20)} MiB`;
  if (all > MOST_BYTES) {
    throw new Refused(`These files have ${megabytes(all)}; a page reads ${megabytes(MOST_BYTES)} at most. The command magcomp reads more.`);
  }
  let done = 0;
  for (const file of files) {
    const at = room(file.size);
    for (let from = 0; from < file.size; from += SLICE) {
      const part = await file.slice(from, from + SLICE).arrayBuffer().catch((error) => {
        throw new Refused(`${file.name} cannot be read: ${error.message}`);
      });
      view(at + from, part.byteLength).set(new Uint8Array(part));
      done += part.byteLength;
      postMessage({ doing: "Reading", share: 0.1 * (done / all) });
    }
    module.file(...given(file.name), at, file.size);
  }
}

async function replay({ wasm, files, settings }) {
  const unpacked = new Blob([wasm]).stream().pipeThrough(new DecompressionStream("gzip"));
  const { instance } = await WebAssembly.instantiate(await new Response(unpacked).arrayBuffer(), {});
  module = instance.exports;
  module.begin();
  await read(files);
  postMessage({ doing: "Looking at the file", share: 0.1 });
  checked(module.open(...given(JSON.stringify(settings))));
  const opened = JSON.parse(textOf(out()));
  const lines = [];
  let rows = 0;
  for (let played = 1; played > 0; ) {
    played = checked(module.play());
    lines.push(out().slice());
    rows += played;
    const doing = `Replaying: ${rows.toLocaleString("en")} of ${opened.rows.toLocaleString("en")} samples`;
    postMessage({ doing, share: 0.1 + 0.88 * (rows / opened.rows) });
  }
  postMessage({ doing: "Drawing", share: 0.99 });
  checked(module.calibration());
  const calibration = textOf(out());
  checked(module.report());
  postMessage({ opened, calibration, report: textOf(out()), readings: new Blob(lines, { type: "text/csv" }) });
}

onmessage = ({ data }) => replay(data).catch((error) => {
  if (error instanceof Refused) return postMessage({ refused: error.message });
  let why = "The reader stopped within these files: they are damaged, or need more memory than a page has. The command magcomp tells which.";
  if (module !== null && module.panicked_bytes() > 0) {
    why = `This is a fault of magcomp, please report it: ${textOf(view(module.panicked(), module.panicked_bytes()))}`;
  } else if (!(error instanceof WebAssembly.RuntimeError)) why = `This browser cannot run the replay: ${error.message}`;
  postMessage({ refused: why });
});
