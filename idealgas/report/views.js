// ── the pictures ──

function themed() {
  const style = getComputedStyle(document.documentElement);
  const dark = !printing && matchMedia("(prefers-color-scheme: dark)").matches;
  const onPaper = { "--ink": "#1a1a1a", "--panel": "#ffffff" };
  const colour = name => printing ? onPaper[name] : style.getPropertyValue(name).trim();
  return { dark, ink: colour("--ink"), panel: colour("--panel"), soft: printing ? "#5f5f5f" : colour("--soft") };
}

// Prepare a canvas that is as wide as the page, with height/width = `ratio` within limits. inset: free width on each side.
function prepare(canvas, ratio, lowest, tallest) {
  const width = canvas.clientWidth || 600;
  const scale = window.devicePixelRatio || 1;
  const height = Math.min(Math.max(width * ratio, lowest), tallest);
  const inset = Math.max(width - height / ratio, 0) / 2;
  const pixels = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== pixels[0] || canvas.height !== pixels[1]) {
    [canvas.width, canvas.height] = pixels;
    canvas.style.height = height + "px";
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height, inset };
}

const SMALLEST = 1.25; // smallest radius with which a disc is drawn, pixels

class DiscView {
  constructor(canvas, gas) {
    this.canvas = canvas;
    this.gas = gas;
    this.shade = new Uint8Array(gas.number);
    this.colouring = "speed"; // or "species", "order"
    this.chosen = null; // id of the disc whose flight is shown
  }

  show(gas) { this.gas = gas; }

  // The disc below a pointer.
  discAt(event) {
    const box = this.canvas.getBoundingClientRect();
    return this.gas.nearest((event.clientX - box.left - this.inset) / this.scale,
      (box.height - event.clientY + box.top) / this.scale);
  }

  // The list of colours; `shade` is set to the index of the colour of each disc.
  shades(theme) {
    const { gas, shade } = this, { head } = gas;
    if (this.colouring === "order") shade.set(gas.orders());
    const colours = head.colours[this.colouring] ?? (theme.dark ? head.dark : head.light);
    for (let i = 0; i < gas.number && this.colouring !== "order"; i++) {
      shade[i] = this.colouring === "species" ? gas.species[i] % colours.length
        : Math.min(Math.floor(gas.speed(i) / head.brightest * colours.length), colours.length - 1);
    }
    return colours;
  }

  draw() {
    const { gas } = this, { head } = gas, [boxX, boxY] = head.box;
    const { pen, width, height, inset } = prepare(this.canvas, boxY / boxX, 0, Math.max(240, Math.min(640, innerHeight / 2)));
    const theme = themed(), shades = this.shades(theme);
    const scale = (width - 2 * inset) / boxX;
    [this.inset, this.scale] = [inset, scale];
    pen.fillStyle = theme.panel;
    pen.fillRect(inset, 0, width - 2 * inset, height);
    pen.save();
    pen.beginPath();
    pen.rect(inset, 0, width - 2 * inset, height);
    pen.clip();
    for (let s = 0; s < shades.length; s++) {
      pen.beginPath();
      for (let i = 0; i < gas.number; i++) {
        if (this.shade[i] === s) this.outline(pen, i, inset, height, scale, boxX, boxY);
      }
      pen.fillStyle = shades[s];
      pen.fill();
    }
    pen.fillStyle = theme.ink;
    for (const wall of head.walls.filter(wall => wall.radius > 0)) { // fixed discs
      for (const x of head.periodic[0] ? [-boxX, 0, boxX] : [0]) {
        for (const y of head.periodic[1] ? [-boxY, 0, boxY] : [0]) {
          pen.beginPath();
          pen.arc(inset + (wall.points[0][0] + x) * scale, height - (wall.points[0][1] + y) * scale, wall.radius * scale, 0, 7);
          pen.fill();
        }
      }
    }
    if (this.chosen !== null) this.drawFlight(pen, theme, inset, height, scale);
    pen.restore();
    pen.strokeStyle = theme.ink;
    pen.strokeRect(inset + 0.5, 0.5, width - 2 * inset - 1, height - 1);
    pen.lineWidth = 2;
    for (const wall of head.walls) {
      if (wall.radius > 0) continue;
      const open = wall.absent.some(([opens, closes]) => gas.time >= opens && gas.time < closes);
      pen.strokeStyle = open ? theme.soft : theme.ink;
      pen.lineWidth = open ? 1 : 2;
      pen.setLineDash(open ? [1, 5] : wall.permeable ? [6, 4] : []);
      this.line(pen, wall.points.map(([x, y]) => [x * scale, y * scale]), inset, height);
      pen.setLineDash([]);
      const from = wall.points[0], to = wall.points.at(-1), [x, y] = from[1] > to[1] ? from : to; // the upper end
      this.label(pen, theme, open ? `${wall.name}, open` : wall.name, inset + x * scale, height - y * scale);
    }
    for (const piston of gas.pistons) {
      pen.lineWidth = 3;
      pen.strokeStyle = head.pistonColour;
      const place = gas.placeOf(piston) * scale, along = piston.axis === 0;
      this.line(pen, along ? [[place, 0], [place, height]] : [[0, place], [boxX * scale, place]], inset, height);
      this.label(pen, theme, piston.name, inset + (along ? place : 0), along ? 0 : height - place);
    }
    pen.lineWidth = 1;
    if (head.gravity.some(g => g !== 0)) this.arrow(pen, theme, head.gravity, width - inset - 28, 28);
  }

  // Write a word beside a point, inside the picture and legible on top of discs.
  label(pen, theme, text, x, y) {
    pen.font = "12px system-ui, sans-serif";
    const wide = pen.measureText(text).width, right = this.canvas.clientWidth - this.inset;
    pen.textAlign = "left";
    const [left, base] = [x + 6 + wide > right - 4 ? x - 6 - wide : x + 6, Math.max(y, 0) + 16];
    [pen.lineWidth, pen.strokeStyle, pen.fillStyle] = [4, theme.panel, theme.ink];
    pen.strokeText(text, left, base);
    pen.fillText(text, left, base);
  }

  arrow(pen, theme, [gx, gy], x, y) {
    const g = Math.hypot(gx, gy), [dx, dy] = [gx / g, -gy / g], [toX, toY] = [x + 14 * dx, y + 14 * dy];
    for (const [width, colour] of [[5, theme.panel], [1.5, theme.ink]]) {
      [pen.lineWidth, pen.strokeStyle] = [width, colour];
      pen.beginPath();
      pen.moveTo(x - 14 * dx, y - 14 * dy);
      pen.lineTo(toX, toY);
      pen.moveTo(toX - 6 * dx - 4 * dy, toY - 6 * dy + 4 * dx);
      pen.lineTo(toX, toY);
      pen.lineTo(toX - 6 * dx + 4 * dy, toY - 6 * dy - 4 * dx);
      pen.stroke();
    }
    this.label(pen, theme, "g", x + 2, y - 12);
    pen.lineWidth = 1;
  }

  // Draw the flight of the chosen disc since its last event, unwrapped across periodic sides.
  drawFlight(pen, theme, inset, height, scale) {
    const { gas } = this, i = this.chosen, { places } = gas.flight(i, 32), [x, y] = places[32];
    [pen.lineWidth, pen.strokeStyle] = [1.5, theme.ink];
    pen.beginPath();
    places.forEach(([px, py]) => {
      pen.lineTo(inset + (px + gas.x[i] - x) * scale, height - (py + gas.y[i] - y) * scale);
    });
    pen.stroke();
    pen.beginPath();
    pen.lineWidth = 2.5;
    this.disc(pen, inset + gas.x[i] * scale, height - gas.y[i] * scale, Math.max(gas.radius[i] * scale, 1.5) + 3);
    pen.stroke();
    pen.lineWidth = 1;
  }

  line(pen, points, inset, height) {
    pen.beginPath();
    for (const [x, y] of points) pen.lineTo(inset + x, height - y);
    pen.stroke();
  }

  outline(pen, i, inset, height, scale, boxX, boxY) {
    const { gas } = this, { periodic: [periodicX, periodicY], slide } = gas.head;
    const x = gas.x[i], y = gas.y[i], r = Math.max(gas.radius[i], SMALLEST / scale);
    const row = (x, y) => {
      const imageX = periodicX ? (x < r ? boxX : x > boxX - r ? -boxX : 0) : 0;
      this.disc(pen, inset + x * scale, height - y * scale, r * scale);
      if (imageX) this.disc(pen, inset + (x + imageX) * scale, height - y * scale, r * scale);
    };
    row(x, y);
    const imageY = periodicY ? (y < r ? boxY : y > boxY - r ? -boxY : 0) : 0;
    if (imageY) {
      const there = x + Math.sign(imageY) * slide * gas.time; // beyond sheared sides images move
      row(slide ? there - Math.floor(there / boxX) * boxX : x, y + imageY);
    }
  }

  disc(pen, x, y, r) {
    if (r < 1.5) { // a square looks the same and is drawn faster
      pen.rect(x - r, y - r, 2 * r, 2 * r);
    } else {
      pen.moveTo(x + r, y);
      pen.arc(x, y, r, 0, 2 * Math.PI);
    }
  }
}

class SpeedView {
  constructor(canvas, gas) {
    this.canvas = canvas;
    this.counts = new Float64Array(40);
    this.show(gas);
  }

  show(gas) {
    const rescaled = gas.head.fastest !== this.gas?.head.fastest;
    this.gas = gas;
    if (rescaled) this.top = 1.8 * Math.max(...this.law(this.temperature())) || 1;
  }

  temperature() {
    const { gas } = this;
    let energy = 0, number = 0;
    for (let i = 0; i < gas.number; i++) {
      const kinetic = gas.mass[i] * gas.speed(i) ** 2 / 2;
      if (kinetic >= 0) [energy, number] = [energy + kinetic, number + 1]; // NaN for a disc that has left
    }
    return energy / (number || 1);
  }

  law(temperature) {
    const { head } = this.gas;
    return Array.from({ length: 201 }, (_, k) => {
      if (!(temperature > 0)) return 0;
      const v = head.fastest * k / 200;
      return head.kinds.reduce((sum, kind) => {
        const share = kind.mass / temperature;
        return sum + kind.share * share * v * Math.exp(-share * v * v / 2);
      }, 0);
    });
  }

  draw() {
    const { gas, counts } = this, { head } = gas;
    const { pen, width, height } = prepare(this.canvas, 0.32, 180, 220);
    const theme = themed(), left = 52, bottom = 48, right = 12, above = 24, strip = 8;
    const shades = theme.dark ? head.dark : head.light;
    const w = width - left - right, h = height - bottom - above;
    const toX = v => left + v / head.fastest * w, toY = f => above + h * (1 - Math.min(f / this.top, 1));
    counts.fill(0);
    for (let i = 0; i < gas.number; i++) {
      const bin = Math.floor(gas.speed(i) / head.fastest * counts.length);
      if (bin < counts.length) counts[bin]++;
    }
    pen.fillStyle = theme.panel;
    pen.fillRect(left, above, w, h);
    const wide = head.fastest / counts.length;
    pen.fillStyle = head.bars;
    counts.forEach((count, k) => {
      const y = toY(count / gas.number / wide);
      pen.fillRect(toX(k * wide), y, w / counts.length + 0.5, above + h - y);
    });
    const temperature = this.temperature();
    pen.strokeStyle = theme.dark ? theme.ink : head.curve;
    pen.lineWidth = 2;
    if (head.mixes) {
      pen.beginPath();
      this.law(temperature).forEach((f, k) => pen.lineTo(toX(head.fastest * k / 200), toY(f)));
      pen.stroke();
    }
    shades.forEach((shade, k) => {
      const from = toX(head.brightest * k / shades.length), last = k + 1 === shades.length;
      pen.fillStyle = shade;
      pen.fillRect(from, above + h, (last ? left + w : toX(head.brightest * (k + 1) / shades.length)) - from, strip);
    });
    pen.lineWidth = 1;
    pen.strokeStyle = theme.ink;
    pen.fillStyle = theme.ink;
    pen.font = "12px system-ui, sans-serif";
    pen.strokeRect(left + 0.5, above + 0.5, w, h);
    pen.textAlign = "center";
    const step = roundStep(head.fastest * 60 / w);
    for (let v = 0; v <= head.fastest; v += step) pen.fillText(+v.toPrecision(6), toX(v), above + h + strip + 14);
    const moves = head.flow.some(v => v !== 0);
    pen.fillText(`speed ${moves ? "relative to the gas " : ""}(length/time)`, left + w / 2, above + h + strip + 32);
    pen.textAlign = "right";
    const rise = roundStep(this.top / 4);
    for (let f = 0; f <= this.top; f += rise) pen.fillText(+f.toPrecision(3), left - 6, toY(f) + 4);
    const key = head.mixes ? "bars: discs, line: Maxwell-Boltzmann at " : "bars: discs, which hardly collide, at ";
    pen.fillText((w > 480 ? key : "") + "T = " + temperature.toPrecision(5), left + w, 15);
    pen.textAlign = "left";
    pen.fillText("density (time/length)", 4, 15);
  }
}

function roundStep(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return power * [1, 2, 5, 10].find(step => power * step >= size * (1 - 1e-9));
}
