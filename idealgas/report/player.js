// ── the player ──

const WHOLE = 20; // seconds in which a page plays a whole run, unless another rate is chosen

class Player {
  constructor(gas) {
    this.gas = gas;
    this.playing = false;
    this.rate = 1;
    this.scrub = document.getElementById("scrub");
    this.button = document.getElementById("play");
    this.clock = document.getElementById("clock");
    this.rates = document.getElementById("rate");
    this.views = [new SpeedView(document.getElementById("speeds"), gas)];
    if (gas.head.positions) this.showDiscs(document.getElementById("discs"));
    this.findCurves();
    this.button.addEventListener("click", () => this.toggle());
    this.scrub.addEventListener("input", () => { this.pause(); this.seek(this.at(this.scrub.value / this.scrub.max)); });
    this.rates.addEventListener("change", () => { this.rate = +this.rates.value; });
    document.getElementById("player").addEventListener("keydown", event => this.key(event));
    new ResizeObserver(() => this.draw()).observe(document.getElementById("speeds"));
    new ResizeObserver(wrapTables).observe(document.getElementById("sections"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.draw();
  }

  // Show the discs and, if one is chosen, its flight. A colouring in which all discs would look the same is not offered.
  showDiscs(canvas) {
    const view = new DiscView(canvas, this.gas), field = document.getElementById("chosen");
    const colours = document.getElementById("colour");
    if (this.gas.head.kinds.length < 2) colours.querySelector("[value=species]").remove();
    if (!this.gas.order.length) colours.querySelector("[value=order]").remove();
    colours.addEventListener("change", () => {
      view.colouring = colours.value;
      canvas.setAttribute("aria-label", `The discs in their box, coloured by ${colours.value}`);
      this.draw();
    });
    this.views.push(view);
    this.discs = view;
    field.max = this.gas.number - 1;
    const choose = text => {
      const number = text === "" ? NaN : +text;
      view.chosen = Number.isInteger(number) && number >= 0 && number < this.gas.number ? number : null;
      this.draw();
    };
    field.addEventListener("input", () => choose(field.value));
    canvas.addEventListener("click", event => choose(field.value = String(view.discAt(event))));
  }

  // Add the rate at which the whole motion is played in WHOLE seconds to the list of rates, in order.
  offerWhole() {
    const { start, end, speed } = this.gas.head, value = (end - start) / speed / WHOLE;
    const faster = Array.from(this.rates.options).find(option => +option.value > value) ?? null;
    this.rates.add(new Option(`all in ${WHOLE} s`, value, true, true), faster);
    this.rate = value;
  }

  get time() { return this.gas.time; }

  at(share) { return this.gas.head.start + share * (this.gas.head.end - this.gas.head.start); }

  seek(time) {
    this.gas.seek(time);
    this.draw();
  }

  // Go to the time of a click on a curve.
  jump(time) {
    this.pause();
    this.seek(time);
  }

  findCurves() { this.curves = makeCurves(time => this.jump(time)); }

  positions() { return Array.from(this.gas.x, (x, i) => [x, this.gas.y[i]]); }

  draw() {
    const { head, time } = this.gas;
    [...this.views, ...this.curves].forEach(view => view.draw(this.gas));
    this.scrub.value = this.scrub.max * (time - head.start) / (head.end - head.start);
    this.scrub.setAttribute("aria-valuetext", "t = " + time.toPrecision(5));
    this.clock.textContent = "t = " + time.toPrecision(6);
    document.getElementById("flight").textContent = this.inWords(this.discs?.chosen ?? null);
  }

  inWords(i) {
    if (i === null) return "";
    const { since } = this.gas.flight(i, 1), speed = Math.hypot(this.gas.vx[i], this.gas.vy[i]);
    if (Number.isNaN(speed)) return `disc ${i} left the gas at t = ${since.toPrecision(6)}`;
    return `disc ${i}: speed ${speed.toPrecision(4)}, in free flight since t = ${since.toPrecision(6)}`;
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  play() {
    if (this.time >= this.gas.head.end) this.restart();
    this.playing = true;
    this.button.textContent = "Pause";
    let before = null;
    const frame = now => {
      if (!this.playing) return;
      const seconds = Math.min((now - (before ?? now)) / 1000, 0.25); // limited, as a hidden page has no frames
      this.seek(this.time + seconds * this.rate * this.gas.head.speed);
      before = now;
      this.played();
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  restart() { this.seek(this.gas.head.start); }

  // Called after each frame while playing.
  played() {
    if (this.time >= this.gas.head.end) this.pause();
  }

  pause() {
    this.playing = false;
    this.button.textContent = "Play";
  }

  key(event) {
    if (["rate", "colour", "chosen"].includes(event.target.id) || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.target === this.button && event.key === " ") return; // the browser makes this a click
    const second = this.rate * this.gas.head.speed, small = event.shiftKey ? second : second / 25;
    const act = {
      " ": () => this.toggle(),
      ArrowLeft: () => { this.pause(); this.seek(this.time - small); },
      ArrowRight: () => { this.pause(); this.seek(this.time + small); },
      ArrowUp: () => this.faster(1),
      ArrowDown: () => this.faster(-1),
      Home: () => { this.pause(); this.seek(this.gas.head.start); },
      End: () => { this.pause(); this.seek(this.gas.head.end); },
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  faster(steps) {
    const k = this.rates.selectedIndex + steps;
    if (k < 0 || k >= this.rates.options.length) return;
    this.rates.selectedIndex = k;
    this.rate = +this.rates.value;
  }
}

let printing = false;
wrapTables();
const head = document.getElementById("data-head");
if (head) {
  window.player = new Player(new Gas(JSON.parse(head.textContent)));
  window.player.offerWhole();
  addEventListener("beforeprint", () => { printing = true; window.player.draw(); });
  addEventListener("afterprint", () => { printing = false; window.player.draw(); });
}
