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
  };
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

// A phone of 90 seconds in a hand that turns it about all its axes: the Earth's field of 48 uT, 65 degrees down, a hard iron, and noise.
function example() {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dip = 65 * Math.PI / 180, step = 0.02, iron = [30, -20, 40], parts = 10;
  let up = [0, 0, 9.81], field = [0, 48 * Math.cos(dip), -48 * Math.sin(dip)], draw = 1;
  const noise = (size) => {
    let sum = 0;
    for (let k = 0; k < 4; k += 1) sum += (draw = draw * 16807 % 2147483647) / 2147483647 - 0.5;
    return size * sum * Math.sqrt(3);
  };
  const cells = (vector, size) => vector.map((value) => (value + noise(size)).toFixed(5)).join(",");
  const lines = ["t_s,mx,my,mz,ax,ay,az,gx,gy,gz"];
  for (let row = 0; row < 4500; row += 1) {
    const t = row * step;
    const rate = [0.9 * Math.sin(0.7 * t), 0.7 * Math.sin(0.45 * t + 1), 0.8 * Math.sin(0.31 * t + 2) + 0.2];
    lines.push(`${t.toFixed(2)},${cells(field.map((value, k) => value + iron[k]), 0.4)},${cells(up, 0.05)},${cells(rate, 0.003)}`);
    // a vector that stands still in the world turns the other way in the phone; its length stays
    const turned = (vector) => {
      const length = Math.hypot(...vector);
      for (let part = 0; part < parts; part += 1) {
        const change = cross(vector, rate);
        vector = vector.map((value, k) => value + change[k] * step / parts);
      }
      return vector.map((value) => value * length / Math.hypot(...vector));
    };
    up = turned(up);
    field = turned(field);
  }
  return new File([lines.join("\n") + "\n"], "example.csv");
}

element("example").addEventListener("click", () => start([example()]));
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
