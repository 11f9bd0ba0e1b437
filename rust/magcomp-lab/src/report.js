
// one moment in all pictures over time: the pointer chooses it, or the arrow keys once a picture has the focus
const pictures = [...document.querySelectorAll(".time")];
const show = (seconds) => {
  for (const picture of pictures) {
    const [line, told] = [picture.querySelector("i"), picture.querySelector("output")];
    const { from, to, until } = picture.dataset;
    const share = seconds / until;
    line.hidden = told.hidden = !(share >= 0 && share <= 1);
    line.style.left = told.style.left = `${100 * (+from + share * (to - from))}%`;
    told.textContent = `${seconds.toFixed(1)} s`;
  }
};
for (const picture of pictures) {
  const { from, to, until } = picture.dataset;
  const chosen = (event) => {
    const { left, width } = picture.getBoundingClientRect();
    show(((event.clientX - left) / width - from) / (to - from) * until);
  };
  picture.addEventListener("pointermove", chosen);
  picture.addEventListener("pointerdown", chosen);
  picture.tabIndex = 0;
  let seconds = 0;
  picture.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!steps) return;
    event.preventDefault();
    seconds = Math.min(until, Math.max(0, seconds + steps * until / (event.shiftKey ? 20 : 200)));
    show(seconds);
  });
}
