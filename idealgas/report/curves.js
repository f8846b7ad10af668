// ── the curves of the page: they show the time of the player, and a click on a curve moves the player to that time ──

class Curve {
  constructor(svg, axes) {
    [this.svg, this.axes] = [svg, axes];
    this.own = axes.strips ? [] : [this.add("line", "cursor")];
  }

  add(name, kind) {
    const element = document.createElementNS(this.svg.namespaceURI, name);
    element.setAttribute("class", kind);
    return this.svg.appendChild(element);
  }

  x(value) {
    const { place: [left, right], x: [low, high] } = this.axes;
    return left + (right - left) * (value - low) / (high - low);
  }

  y(value) {
    const { place: [, , bottom, top], y, logarithmic } = this.axes;
    const [v, low, high] = logarithmic ? [value, ...y].map(Math.log) : [value, ...y];
    return bottom + (top - bottom) * Math.min(Math.max((v - low) / (high - low), 0), 1);
  }

  // The time at the position of a pointer, within the limits of the axis.
  timeAt(event) {
    const { place: [left, right], x: [low, high] } = this.axes, box = this.svg.getBoundingClientRect();
    const at = (event.clientX - box.left) / box.width * this.svg.viewBox.baseVal.width;
    return low + (high - low) * Math.min(Math.max((at - left) / (right - left), 0), 1);
  }

  draw(gas) {
    if (this.axes.strips) this.drawStrips(gas); else this.drawCursor(gas.time);
  }

  drawCursor(time) {
    const { place: [, , bottom, top], x: [low, high] } = this.axes, [line] = this.own, at = this.x(time);
    line.style.display = time < low || time > high ? "none" : "";
    for (const [name, value] of [["x1", at], ["x2", at], ["y1", bottom], ["y2", top]]) line.setAttribute(name, value);
  }

  // The density of every species at this instant, as a step curve.
  drawStrips(gas) {
    const { axis, first, last, number, area } = this.axes.strips, place = axis === 0 ? gas.x : gas.y;
    const counts = [];
    for (let i = 0; i < gas.number; i++) {
      const strip = Math.floor((place[i] - first) / (last - first) * number);
      const ofSpecies = counts[gas.species[i]] ??= new Array(number).fill(0);
      ofSpecies[Math.min(Math.max(strip, 0), number - 1)]++;
    }
    counts.forEach((ofSpecies, k) => {
      const steps = ofSpecies.map((count, strip) => {
        const [from, to] = [strip, strip + 1].map(edge => this.x(first + (last - first) * edge / number));
        return `${strip ? "L" : "M"}${from} ${this.y(count / area)}H${to}`;
      });
      this.own[k] ??= this.add("path", "now");
      this.own[k].style.stroke = `var(--c${k % 6})`;
      this.own[k].setAttribute("d", steps.join(""));
    });
  }
}

function makeCurves(seek) {
  const curves = [];
  for (const svg of document.querySelectorAll("svg[data-axes]")) {
    const axes = JSON.parse(svg.dataset.axes);
    if (!axes.time && !axes.strips) continue;
    const curve = new Curve(svg, axes);
    curves.push(curve);
    if (!axes.time) continue;
    svg.classList.add("clickable");
    svg.addEventListener("pointerdown", event => seek(curve.timeAt(event)));
    svg.addEventListener("pointermove", event => { if (event.buttons & 1) seek(curve.timeAt(event)); });
  }
  return curves;
}

// If a table is wider than the page, its rows become lists, with each number below its heading.
function wrapTables() {
  for (const frame of document.querySelectorAll(".wide")) {
    const table = frame.firstElementChild;
    table.classList.remove("wrapped");
    if (table.scrollWidth > frame.clientWidth) table.classList.add("wrapped");
  }
}
