// ── a log that may still be written: one part of the motion after the other, from the server of the page ──

let received = {}, live = null;
stored = name => received[name];

const newest = document.getElementById("newest"), state = document.getElementById("state");

// Answer of the server; null if it has ended or refuses.
async function ask(what) {
  const answer = await fetch(what).catch(() => null);
  if (answer?.ok) return answer.json();
  state.textContent = answer ? await answer.text() : "The server of this page has ended.";
  return null;
}

// The part of the motion after a time, or the newest one.
const askPart = after => ask(`part?after=${after}&newest=${+newest.checked}`);

const seconds = number => new Promise(wake => setTimeout(wake, 1000 * number));

class LivePlayer extends Player {
  restart() {} // the next part follows

  // Ask for the next part shortly before it is needed, and show it after this one.
  played() {
    const { head } = this.gas;
    if (!this.asked && head.end - this.time < this.rate * head.speed / 2) this.prepare(head.end);
    if (this.time < head.end || !this.next) return;
    const next = this.next;
    this.asked = this.next = null;
    if (next.motion) this.show(next.motion); else this.pause();
  }

  // Ask until the log has more after a time, or has ended.
  async prepare(after) {
    const asked = this.asked = {};
    let part = await askPart(after);
    while (part?.running && !part.motion && this.asked === asked) {
      await seconds(0.5);
      part = await askPart(after);
    }
    if (this.asked === asked) this.next = part ?? {};
  }

  // Scales stay the same from part to part, unless the gas has become much faster or slower.
  show({ head, arrays }) {
    const { fastest, brightest } = this.gas.head;
    if (Math.abs(Math.log(head.fastest / fastest)) < 0.3) Object.assign(head, { fastest, brightest });
    received = arrays;
    this.gas = new Gas(head);
    this.views.forEach(view => view.show(this.gas));
    this.draw();
  }

  async jump(time) {
    this.pause();
    const { start, end } = this.gas.head;
    if (start <= time && time <= end) return this.seek(time);
    newest.checked = false;
    this.asked = this.next = null;
    const part = await askPart(time);
    if (part?.motion) this.show(part.motion);
  }
}

async function start() {
  let part;
  while ((part = await askPart(0)) && !part.motion) await seconds(0.5);
  if (!part) return;
  received = part.motion.arrays;
  window.player = live = new LivePlayer(new Gas(part.motion.head));
  live.play();
}

// The curves, as long as they grow.
async function grow() {
  let points = 0, found;
  while ((found = await ask(`curves?points=${points}`)) && (found.running || found.points > points)) {
    state.textContent = found.state;
    if (found.points > points) {
      document.getElementById("sections").innerHTML = found.html;
      live?.findCurves();
    }
    points = found.points;
    await seconds(1);
  }
  if (found) state.textContent = found.state;
}

start();
grow();
