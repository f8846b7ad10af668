// ── a log that a run may still be writing: the motion part by part, from the server of the page ──

let received = {}, live = null;
stored = name => received[name];

const newest = document.getElementById("newest"), state = document.getElementById("state");

// The answer of the server; null if it has ended or refuses the request.
async function request(what) {
  const answer = await fetch(what).catch(() => null);
  if (answer?.ok) return answer.json();
  state.textContent = answer ? await answer.text() : "The server of this page has ended.";
  return null;
}

// The part of the motion after a time, or the newest part.
const requestPart = after => request(`part?after=${after}&newest=${+newest.checked}`);

const seconds = number => new Promise(wake => setTimeout(wake, 1000 * number));

class LivePlayer extends Player {
  restart() {} // nothing to do, as the next part follows

  // Request the next part shortly before it is needed, and show it when this part ends.
  played() {
    const { head } = this.gas;
    if (!this.asked && head.end - this.time < this.rate * head.speed / 2) this.prepare(head.end);
    if (this.time < head.end || !this.next) return;
    const next = this.next;
    this.asked = this.next = null;
    if (next.motion) this.show(next.motion); else this.pause();
  }

  // Request a part until the log continues beyond a time or the run has ended.
  async prepare(after) {
    const asked = this.asked = {};
    let part = await requestPart(after);
    while (part?.running && !part.motion && this.asked === asked) {
      await seconds(0.5);
      part = await requestPart(after);
    }
    if (this.asked === asked) this.next = part ?? {};
  }

  // Keep the scales of the previous part unless the gas has become much faster or slower.
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
    const part = await requestPart(time);
    if (part?.motion) this.show(part.motion);
  }
}

async function start() {
  let part;
  while ((part = await requestPart(0)) && !part.motion) await seconds(0.5);
  if (!part) return;
  received = part.motion.arrays;
  window.player = live = new LivePlayer(new Gas(part.motion.head));
  live.play();
}

// Update the curves as long as they grow.
async function grow() {
  let points = 0, curves;
  while ((curves = await request(`curves?points=${points}`)) && (curves.running || curves.points > points)) {
    state.textContent = curves.state;
    if (curves.points > points) {
      document.getElementById("sections").innerHTML = curves.html;
      live?.findCurves();
    }
    points = curves.points;
    await seconds(1);
  }
  if (curves) state.textContent = curves.state;
}

start();
grow();
