// one moment in all pictures over time: the pointer chooses it, or the arrow keys once a picture has the focus
// what is told of a replay stands before its pictures: seconds, heading, its two sigmas, error against the reference (null where there is none), status
const pictures = [];
let moments = [];
for (const part of document.querySelectorAll(".time, script.moments")) {
  if (part.matches(".time")) pictures.push({ part, moments });
  else moments = JSON.parse(part.textContent);
}
const at = (moments, seconds) => {
  let [low, high] = [0, moments.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (moments[middle][0] <= seconds) low = middle + 1; else high = middle;
  }
  return moments[low - 1];
};
const told = (moments, seconds) => {
  const lines = [`${seconds.toFixed(1)} s`], moment = at(moments, seconds);
  if (moment === undefined) return lines[0];
  const [, heading, twoSigma, error, status] = moment;
  if (heading === null) lines.push("no heading");
  else lines.push(`heading ${heading.toFixed(0)} deg${twoSigma === null ? "" : `, two sigmas ${twoSigma.toFixed(1)}`}`);
  if (error !== null) lines.push(`error ${error.toFixed(1)} deg`);
  lines.push(status);
  return lines.join("\n");
};
const show = (chosen, seconds) => {
  for (const { part, moments } of pictures.filter((picture) => picture.moments === chosen)) {
    const [line, words] = [part.querySelector("i"), part.querySelector("output")];
    const { from, to, until } = part.dataset;
    const share = seconds / until;
    line.hidden = words.hidden = !(share >= 0 && share <= 1);
    line.style.left = words.style.left = `${100 * (+from + share * (to - from))}%`;
    words.classList.toggle("left", share > 0.6);
    words.textContent = told(moments, seconds);
  }
};
for (const { part, moments } of pictures) {
  const { from, to, until } = part.dataset;
  const chosen = (event) => {
    const { left, width } = part.getBoundingClientRect();
    show(moments, ((event.clientX - left) / width - from) / (to - from) * until);
  };
  part.addEventListener("pointermove", chosen);
  part.addEventListener("pointerdown", chosen);
  let seconds = 0;
  part.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!steps) return;
    event.preventDefault();
    seconds = Math.min(until, Math.max(0, seconds + steps * until / (event.shiftKey ? 20 : 200)));
    show(moments, seconds);
  });
}
