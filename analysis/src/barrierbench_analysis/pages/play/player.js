// The page: reads what it was given, makes the views, and ties slider, buttons and cameras to them.

const $ = (id) => document.getElementById(id);
const words = JSON.parse($("words").textContent);
const SPEEDS = [1, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01];  // simulated seconds in a second
const WATCH_S = 8;  // a film is watched in about this time
const AZIMUTH = -60, ELEVATION = 22;  // degrees, direction to the camera

const number = (value) => String(Number(value.toPrecision(4)));

async function inflated(id) {
  const packed = Uint8Array.from(atob($(id).textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** K3D is a module of AMD without needs of its own. */
async function loadLibrary() {
  const source = new TextDecoder().decode(await inflated("library"));
  let made;
  new Function("define", source)((name, needs, make) => { made = make(); });
  return made;
}

const dark = matchMedia("(prefers-color-scheme: dark)");
const ground = () => (dark.matches ? 0x14171c : 0xffffff);

function figureOf(film, number) {
  const figure = document.createElement("figure"), caption = document.createElement("figcaption");
  const name = document.createElement("b"), outcome = document.createElement("span"), when = document.createElement("span");
  const twice = words.films.every((other) => other.formulation === words.films[0].formulation) && words.films.length > 1;
  name.textContent = twice ? `${film.formulation} (${film.run})` : film.formulation;
  outcome.textContent = film.outcome;
  outcome.className = film.outcome === "ok" ? "" : "bad";
  when.className = "when";
  caption.append(name, " · outcome ", outcome, when);
  const plot = document.createElement("div");
  plot.className = "plot";
  plot.tabIndex = 0;
  plot.setAttribute("role", "img");
  plot.setAttribute("aria-label", `View ${number + 1}: ${film.scene} with ${film.formulation}, run ${film.run}`);
  figure.append(caption, plot);
  $("views").append(figure);
  return {plot, when};
}

/** Where the camera stands at first: the corners of the box round all that is shown are in the picture, in
 * whatever form the view has. */
function homeCamera(plot) {
  const [a, e] = [AZIMUTH, ELEVATION].map((angle) => angle * Math.PI / 180), {low, high, middle, planar} = words;
  const way = planar ? [0, 0, 1] : [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
  const up = planar ? [0, 1, 0] : [0, 0, 1], right = unit(cross(up, way)), above = cross(way, right);
  const tall = 0.94 * Math.tan(Math.PI / 360 * FIELD_OF_VIEW[planar ? "planar" : "solid"]);
  const wide = tall * plot.clientWidth / Math.max(plot.clientHeight, 1);
  let away = 0;
  for (let k = 0; k < 8; k++) {
    const arm = add([0, 1, 2].map((c) => (k >> c & 1 ? high : low)[c]), middle, -1);
    away = Math.max(away, dot(arm, way) + Math.max(Math.abs(dot(arm, right)) / wide, Math.abs(dot(arm, above)) / tall));
  }
  return [...add(middle, way, away), ...middle, ...up];
}

/** The camera of one view is that of all. */
function tieCameras(views) {
  let busy = false;
  for (const view of views) {
    view.plot.on(view.plot.events.CAMERA_CHANGE, (camera) => {
      if (busy) return;
      busy = true;
      for (const other of views) if (other !== view) other.plot.setCamera(camera);
      busy = false;
    });
  }
}

/** Arrow keys turn the camera round its target, + and - zoom. */
function keyTurn(camera, key) {
  const target = camera.slice(3, 6), arm = add(camera.slice(0, 3), target, -1);
  const zoom = {"+": 0.9, "=": 0.9, "-": 1 / 0.9}[key];
  if (zoom) return [...add(target, arm, zoom), ...camera.slice(3)];
  const turn = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]}[key];
  if (!turn || words.planar) return null;
  const length = Math.hypot(...arm), a = Math.atan2(arm[1], arm[0]) + turn[0];
  const e = Math.min(Math.max(Math.asin(arm[2] / length) + turn[1], -1.5), 1.5);
  return [...add(target, [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)], length), ...camera.slice(3)];
}

function swatches(entries) {
  const list = document.createElement("ul");
  list.className = "swatches";
  for (const [colour, text] of entries) {
    const item = document.createElement("li"), square = document.createElement("i");
    square.style.background = colour;
    item.append(square, text);
    list.append(item);
  }
  return list;
}

/** The colour bar, or the names of the bodies; and the obstacles. */
function drawBar(colour) {
  const others = [], obstacles = [...new Set(words.films.flatMap((film) => film.obstacles.map((o) => o.name)))];
  if (obstacles.length) others.push([words.obstacle_colour, `${obstacles.join(", ")} (obstacle)`]);
  if (colour === "body") {
    const names = words.films[0].bodies, many = words.body_colours.length;
    $("bar").replaceChildren(swatches([...names.map((name, k) => [words.body_colours[k % many], name]), ...others]));
    return;
  }
  const {label, unit, top, above, colours} = words.scales[colour];
  const scale = document.createElement("div"), ramp = document.createElement("div"), ticks = document.createElement("div");
  const name = document.createElement("div");
  scale.className = "scale"; ramp.className = "ramp"; ticks.className = "ticks"; name.className = "name";
  name.textContent = `${label}, ${unit}`;
  ramp.style.background = `linear-gradient(to right, ${colours.join(", ")})`;
  for (const text of ["0", number(top / 2), number(top) + (above ? " or more" : "")]) {
    const tick = document.createElement("span");
    tick.textContent = text;
    ticks.append(tick);
  }
  scale.append(name, ramp, ticks);
  $("bar").replaceChildren(scale, swatches([[words.not_computed, "not computed (start, or no such field)"], ...others]));
}

class Player {
  constructor(views, whens) {
    Object.assign(this, {views, whens, playing: false, pending: null});
    const all = words.films.flatMap((film) => film.times).sort((a, b) => a - b);
    this.times = all.filter((t, k) => k === 0 || t - all[k - 1] > 1e-9);
    $("time").max = this.times.length - 1;
    this.clock = this.times[0];
  }

  /** Shows the state at a place of the slider; while one is being drawn only the last one asked for waits. */
  async show(place) {
    $("time").value = place;
    const time = this.times[place];
    $("now").textContent = `t = ${number(time)} s (${place + 1} of ${this.times.length})`;
    $("time").setAttribute("aria-valuetext", `${number(time)} seconds`);
    if (this.drawing) { this.pending = place; return; }
    this.drawing = true;
    try {
      await this.draw(time);
    } finally {
      this.drawing = false;
    }
    document.body.dataset.shown = place;
    if (this.pending !== null) { const next = this.pending; this.pending = null; await this.show(next); }
  }

  /** New colours, in turn with the frames that are drawn: the scale says them at once. */
  async recolour(colour) {
    drawBar(colour);
    this.colour = colour;
    await this.show(this.place());
  }

  async draw(time) {
    for (const [k, view] of this.views.entries()) {
      const frame = view.frameAt(time), {times, steps} = view.film;
      if (view.colour !== this.colour) await view.coloured(this.colour);
      await view.shown(frame);
      const what = steps[frame] < 0 ? "start" : `end of step ${steps[frame]}`;
      const over = frame === times.length - 1 && time > times[frame] + 1e-9 ? ", its last frame" : "";
      this.whens[k].textContent = `t = ${number(times[frame])} s (${what}${over})`;
    }
  }

  place() { return Number($("time").value); }

  toggle(on = !this.playing) {
    this.playing = on;
    $("play").textContent = on ? "Pause" : "Play";
    if (!on) return;
    const last = this.times.length - 1;
    this.clock = this.times[this.place() >= last ? 0 : this.place()];
    this.before = null;
    requestAnimationFrame((now) => this.tick(now));
  }

  async tick(now) {
    if (!this.playing) return;
    if (this.before !== null) this.clock += (now - this.before) / 1000 * Number($("speed").value);
    this.before = now;
    let place = 0;
    while (place + 1 < this.times.length && this.times[place + 1] <= this.clock) place += 1;
    if (place !== this.place()) await this.show(place);
    if (place === this.times.length - 1) this.toggle(false);
    else requestAnimationFrame((next) => this.tick(next));
  }
}

function fillChoices(duration) {
  const names = {gap: "gap", stretch: "stretch", force: "contact force", body: "body"};
  for (const [value, text] of Object.entries(names)) $("colour").append(new Option(text, value, false, value === words.colour));
  const wanted = duration / WATCH_S;
  const nearest = SPEEDS.reduce((a, b) => (Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
  for (const speed of SPEEDS) $("speed").append(new Option(speed === 1 ? "real time" : `${speed} of real time`, speed, false, speed === nearest));
}

async function start() {
  const library = await loadLibrary(), views = [], whens = [], plots = [];
  $("title").textContent = [...new Set(words.films.map((film) => film.scene))].join(" and ");
  $("notes").append(...words.notes.map((note) => Object.assign(document.createElement("p"), {textContent: note})));
  const figures = words.films.map(figureOf);
  for (const [k, film] of words.films.entries()) {
    const arrays = unpacked(film, await inflated(`film-${k}`));
    views.push(new View(library, figures[k].plot, film, arrays, words, ground()));
    whens.push(figures[k].when);
    plots.push(figures[k].plot);
  }
  const player = new Player(views, whens);
  fillChoices(player.times[player.times.length - 1] - player.times[0] || 1);
  const home = () => views.forEach((view, k) => view.plot.setCamera(homeCamera(plots[k])));
  for (const view of views) { await view.obstacles(); await view.arrowObject(); }
  $("arrows").hidden = !views.some((view) => view.pushed.length);
  $("arrow-scale").textContent = `(the longest: ${number(words.longest_arrow_N)} N or more)`;
  await player.recolour($("colour").value);
  tieCameras(views);
  home();
  $("time").addEventListener("input", () => { player.toggle(false); player.show(player.place()); });
  $("play").addEventListener("click", () => player.toggle());
  $("colour").addEventListener("change", () => player.recolour($("colour").value));
  $("forces").addEventListener("change", () => {
    for (const view of views) view.showsForces = $("forces").checked;
    player.show(player.place());
  });
  $("home").addEventListener("click", home);
  dark.addEventListener("change", () => views.forEach((view) => { view.plot.setClearColor(ground()); view.plot.render(); }));
  plots.forEach((plot, k) => plot.addEventListener("keydown", (event) => {
    const camera = keyTurn(views[k].plot.getWorld().controls.getCameraArray(), event.key);
    if (camera) { event.preventDefault(); views[k].plot.setCamera(camera); }
  }));
  document.body.dataset.ready = "yes";
}

start().catch((error) => {
  console.error(error);
  $("error").textContent = `This browser cannot play the file: ${error.message}`;
  $("error").hidden = false;
});
