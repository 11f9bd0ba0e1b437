// The page: takes files, starts and ends the worker, shows what it says.
"use strict";
const element = (id) => document.getElementById(id);
const packed = (id) => Uint8Array.from(atob(element(id).textContent), (c) => c.charCodeAt(0));
const workerUrl = URL.createObjectURL(new Blob([element("worker").textContent], { type: "text/javascript" }));
let worker = null, urls = [];

function show(state) {
  for (const id of ["choose", "running", "refused", "done"]) element(id).hidden = !state.includes(id);
}

function end() {
  if (worker !== null) worker.terminate();
  worker = null;
}

function refuse(why) {
  end();
  element("why").textContent = why;
  show(["choose", "refused"]);
}

function offer(id, name, blob) {
  const link = element(id), url = URL.createObjectURL(blob);
  urls.push(url);
  link.href = url;
  link.download = name;
}

function finish({ opened, calibration, report, readings }, name) {
  end();
  urls.forEach((url) => URL.revokeObjectURL(url));
  urls = [];
  element("warnings").replaceChildren(...opened.warnings.map((warning) => {
    const line = document.createElement("li");
    line.textContent = warning;
    return line;
  }));
  element("calibration").hidden = calibration === "";
  element("none").hidden = calibration !== "";
  offer("calibration", `${name}.calibration.json`, new Blob([calibration], { type: "application/json" }));
  offer("readings", `${name}.readings.csv`, readings);
  offer("saved", `${name}.report.html`, new Blob([report], { type: "text/html" }));
  const frame = element("report");
  frame.onload = () => {
    // as high as its content, so that the page scrolls as one
    const fit = () => { frame.style.height = `${frame.contentDocument.documentElement.scrollHeight}px`; };
    new ResizeObserver(fit).observe(frame.contentDocument.body);
    fit();
    // what a screen reader is told, and what stands on the screen first
    const told = (card) => [".verdict", "li"].map((part) => card.querySelector(part)?.textContent.trim().replace(/\.$/, ""));
    const lines = [...frame.contentDocument.querySelectorAll(".card")].map((card) => told(card).filter(Boolean).join(": "));
    element("verdict").textContent = lines.map((line) => `${line}.`).join(" ");
    element("outcome").focus({ preventScroll: true });
    element("outcome").scrollIntoView();
  };
  element("whose").textContent = name;
  element("verdict").textContent = "";
  frame.srcdoc = report;
  show(["choose", "done"]);
}

function start(files) {
  if (files.length === 0) return;
  end();
  const name = files[0].name;
  element("doing").textContent = "Starting";
  element("bar").value = 0;
  element("what").textContent = files.map((file) => file.name).join(", ");
  show(["running"]);
  worker = new Worker(workerUrl);
  worker.onerror = (event) => refuse(`This browser cannot run the replay: ${event.message}`);
  worker.onmessage = ({ data }) => {
    if (data.refused !== undefined) return refuse(data.refused);
    if (data.report !== undefined) return finish(data, name);
    element("doing").textContent = data.doing;
    element("bar").value = data.share;
  };
  const settings = { axis: element("axis").value, place: element("place").value.replace(/\s/g, ""), date: element("date").value };
  worker.postMessage({ wasm: packed("wasm"), files, settings });
}

element("example").addEventListener("click", () => start([new File([packed("recording")], "magnet-after-45-s.csv.gz")]));
element("files").addEventListener("change", (event) => {
  start([...event.target.files]);
  event.target.value = "";
});
element("cancel").addEventListener("click", () => { end(); show(["choose"]); });
const drop = element("choose");
for (const kind of ["dragenter", "dragover", "dragleave", "drop"]) {
  document.addEventListener(kind, (event) => {
    event.preventDefault();
    drop.classList.toggle("over", kind === "dragenter" || kind === "dragover");
  });
}
document.addEventListener("drop", (event) => {
  const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry && item.webkitGetAsEntry());
  if (entries.some((entry) => entry && entry.isDirectory)) return refuse("That is a folder; drop the files in it, or a zip of it.");
  start([...event.dataTransfer.files]);
});
show(["choose"]);
