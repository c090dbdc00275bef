"use strict";
// The page of tact-view: shows what the server sends, sends what the hand does. No library, nothing from elsewhere.

const $ = (id) => document.getElementById(id);
const picture = $("picture");

// ---- Connection: one WebSocket; when it ends, tried again, first soon, then every few seconds.
let holding = false;  // we asked for the part, or have it
let socket = null, retry_ms = 500, me = 0, may_control = false, holder = 0, last_status_ms = 0;

function connect() {
  const scheme = location.protocol === "https:" ? "wss://" : "ws://";
  const mine = new WebSocket(scheme + location.host + "/ws" + location.search);
  socket = mine;
  mine.binaryType = "arraybuffer";
  mine.onopen = () => {
    retry_ms = 500;
    connection("on", "connected");
  };
  mine.onmessage = (event) => (typeof event.data === "string" ? hear(JSON.parse(event.data)) : show(event.data));
  mine.onclose = () => {
    me = 0;
    holder = 0;
    holding = false;
    may_control = false;
    enable();
    connection("off", "disconnected, retrying");
    document.body.classList.add("stale");
    setTimeout(connect, retry_ms);
    retry_ms = Math.min(2 * retry_ms, 4000);
  };
}

function connection(state, words) {
  $("connection").className = state;
  $("connection").textContent = words;
}

function say(message) {
  if (socket && socket.readyState === WebSocket.OPEN && may_control) socket.send(JSON.stringify(message));
}

// ---- Pictures: a letter, then a JPEG. One at a time is decoded for each canvas; of those that come meanwhile the newest counts.
const canvases = {p: picture, g: $("gauss"), s: $("slice"), t: $("strips")};
const decoding = {}, waiting = {};
let pictures_shown = 0;

function show(data) {
  const kind = String.fromCharCode(new Uint8Array(data, 0, 1)[0]);
  if (!canvases[kind]) return;
  if (decoding[kind]) {
    waiting[kind] = data;
    return;
  }
  decoding[kind] = true;
  createImageBitmap(new Blob([new Uint8Array(data, 1)], {type: "image/jpeg"}))
    .then((bitmap) => {
      const canvas = canvases[kind];
      if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
        canvas.width = bitmap.width;
        canvas.height = bitmap.height;
      }
      canvas.getContext("2d").drawImage(bitmap, 0, 0);
      bitmap.close();
      if (kind === "p") {
        pictures_shown += 1;
        document.body.classList.add("live");
        document.body.dataset.pictures = pictures_shown;
      }
    })
    .catch(() => {})
    .finally(() => {
      decoding[kind] = false;
      const next = waiting[kind];
      delete waiting[kind];
      if (next) show(next);
    });
}

// ---- Messages.
function hear(message) {
  if (message.type === "hello") {
    me = message.you;
    may_control = message.control;
    holder = message.holder;
    $("law").replaceChildren(...message.laws.map((law) => new Option(law, law)));
    $("watching").hidden = may_control;
    enable();
  } else if (message.type === "status") {
    status(message);
  } else if (message.type === "hand") {
    holder = message.holder;
    holding = me !== 0 && holder === me;
    enable();
  } else if (message.type === "answer") {
    if (message.accepted) {
      notice(`${label_of(message.key)} is now ${message.value}`);
    } else {
      notice(`${label_of(message.key)}: ${message.message}`, true);
      edited = {};
    }
  } else if (message.type === "service") {
    notice(`${message.service}: ${message.phase}${message.detail ? ", " + message.detail : ""}`, message.phase === "degraded" || message.phase === "gone");
  } else if (message.type === "fault") {
    if (message.on) fault_counts.set(message.words, (fault_counts.get(message.words) || 0) + 1);
  } else if (message.type === "error") {
    notice(message.message, true);
  }
}

const labels = {"contact.law": "Law", "contact.stiffness_n_per_m": "Stiffness", "coupling.saturation": "Saturation", "coupling.kind": "Coupling"};
const label_of = (key) => labels[key] || key;

function notice(words, bad = false) {
  $("notice").textContent = words;
  $("notice").className = bad ? "bad" : "";
}

const fixed = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : "-");
const three = (value) => (Number.isFinite(value) ? Number(value.toPrecision(3)).toString() : "-");

function set(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}

function status(s) {
  last_status_ms = performance.now();
  document.body.classList.toggle("stale", s.age_s < 0 || s.age_s > 1);
  set("scene", s.scene ? `${s.scene}: ${s.points.toLocaleString("en")} points, voxel ${three(s.voxel_mm)} mm` : "no scene yet");
  set("blank", s.scene ? "Drawing" : "Waiting for the contact server");
  set("force", fixed(s.force_n, 2));
  set("depth", fixed(s.penetration_mm, 3));
  set("depth-voxels", `${fixed(s.penetration_voxels, 2)} voxels`);
  set("contacts", String(s.contacts));
  set("torque", fixed(s.torque_nm, 3));
  show_faults(s);
  show_services(s.services);
  // What the user is just changing is left alone until the answer comes.
  if (!busy("law") && s.law) $("law").value = s.law;
  if (!busy("stiffness") && s.k_n_per_m > 0) {
    $("stiffness").value = Math.log10(s.k_n_per_m);
    $("stiffness-number").value = Math.round(s.k_n_per_m);
  }
  if (!busy("coupling") && s.coupling) $("coupling").value = s.coupling;
  if (!busy("saturation")) $("saturation").checked = s.saturation;
  if (s.holder !== holder) {
    holder = s.holder;
    enable();
  }
  const details = {
    "Device": s.device ? `${s.device}, ${s.mode}${s.engaged ? "" : ", not engaged"}` : "none yet",
    "Net stiffness": `${three(s.net_stiffness_n_per_m)} N/m`,
    "Hand": `${fixed(s.hand_force_n, 1)} N${s.capped ? ", capped" : ""}`,
    "Script": s.script_s < 0 ? "none" : s.script_done ? "done" : `${fixed(s.script_s, 1)} s`,
    "Tick": `${fixed(s.tick_us, 0)} \u00b5s`,
    "Round trip": `${fixed(s.round_trip_us, 0)} \u00b5s`,
    "Pictures": `${fixed(s.frames_per_s, 1)} /s, ${fixed(s.cpu_ms_per_frame, 1)} ms each`,
    "Viewers": String(s.viewers),
  };
  const list = $("details");
  if (list.children.length === 0) {
    for (const name of Object.keys(details)) {
      const term = document.createElement("dt"), value = document.createElement("dd");
      term.textContent = name;
      list.append(term, value);
    }
  }
  Object.values(details).forEach((text, i) => {
    const cell = list.children[2 * i + 1];
    if (cell.textContent !== text) cell.textContent = text;
  });
}

// Events count the faults: one that came and went between two states is not missed.
const fault_counts = new Map();
let faults_shown = "";
function show_faults(s) {
  const past = s.faults_ever.filter((words) => !s.faults.includes(words))
    .map((words) => (fault_counts.get(words) > 1 ? `${words} (${fault_counts.get(words)} times)` : words));
  const key = s.faults.join("|") + "#" + past.join("|");
  if (key === faults_shown) return;
  faults_shown = key;
  const items = s.faults.map((words) => ["", words]);
  if (items.length === 0) items.push(["none", "No faults now"]);
  if (past.length > 0) items.push(["past", "Earlier: " + past.join("; ")]);
  $("faults").replaceChildren(...items.map(([kind, words]) => {
    const item = document.createElement("li");
    item.className = kind;
    item.textContent = words;
    return item;
  }));
}

let services_shown = "";
function show_services(services) {
  const key = JSON.stringify(services);
  if (key === services_shown) return;
  services_shown = key;
  $("services").replaceChildren(...services.map((s) => {
    const item = document.createElement("li");
    item.className = s.phase === "active" || s.phase === "ready" ? "good" : s.phase === "degraded" ? "warn" : "";
    item.textContent = `${s.service} ${s.phase}` + (s.progress >= 0 && s.progress < 1 ? ` ${Math.round(100 * s.progress)} %` : "");
    item.title = s.detail;
    return item;
  }));
}

function enable() {
  if (holder !== 0 && holder !== me) holding = false;
  for (const id of ["law", "stiffness", "stiffness-number", "saturation", "coupling", "home"]) $(id).disabled = !may_control;
  const mine = me !== 0 && holder === me;
  $("drop").disabled = !mine;
  picture.classList.toggle("holding", mine);
  $("grip").hidden = holder === 0;
  set("grip", mine ? "you hold the part" : "another viewer holds the part");
}

// ---- Controls.
let edited = {};
const busy = (id) => performance.now() - (edited[id] || -1e9) < 1500;
function change(id, key, value) {
  edited[id] = performance.now();
  say({type: "set", key, value: String(value)});
}
$("law").onchange = () => change("law", "contact.law", $("law").value);
$("coupling").onchange = () => change("coupling", "coupling.kind", $("coupling").value);
$("saturation").onchange = () => change("saturation", "coupling.saturation", $("saturation").checked);
$("stiffness").oninput = () => {
  edited["stiffness"] = performance.now();
  $("stiffness-number").value = Number((10 ** Number($("stiffness").value)).toPrecision(2));
};
const set_stiffness = () => {
  const k = Number($("stiffness-number").value);
  if (!(k >= 100 && k <= 1e6)) {
    notice("Stiffness: from 100 to 1 000 000 N/m", true);
    return;
  }
  $("stiffness").value = Math.log10(k);
  change("stiffness", "contact.stiffness_n_per_m", k);
};
$("stiffness").onchange = set_stiffness;
$("stiffness-number").oninput = () => { edited["stiffness"] = performance.now(); };
$("stiffness-number").onchange = set_stiffness;
$("home").onclick = () => say({type: "home"});
$("drop").onclick = () => drop();

// ---- The hand. What the mouse did since the last frame of the screen goes out as one message.
const none = () => ({dx: 0, dy: 0, dz: 0, rx: 0, ry: 0, rz: 0});
let move = none(), orbit = {yaw: 0, pitch: 0, zoom: 1}, scheduled = false, pointer = null, wheel_timer = 0;

function take() {
  if (!holding) say({type: "take"});
  holding = true;
}
function drop() {
  flush();
  say({type: "drop"});
  holding = false;
}
function schedule() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(flush);
}
function flush() {
  scheduled = false;
  if (Object.values(move).some((v) => v !== 0)) say({type: "move", ...move});
  if (orbit.yaw !== 0 || orbit.pitch !== 0 || orbit.zoom !== 1) say({type: "orbit", ...orbit});
  move = none();
  orbit = {yaw: 0, pitch: 0, zoom: 1};
}
setInterval(() => {
  if (holding && me !== 0) say({type: "keep"});  // a holder that falls silent loses the part
  if (performance.now() - last_status_ms > 2000) document.body.classList.add("stale");
}, 300);

picture.addEventListener("pointerdown", (event) => {
  if (pointer !== null || !may_control) return;
  picture.focus();
  picture.setPointerCapture(event.pointerId);
  const camera = event.button === 2 || event.ctrlKey;
  pointer = {id: event.pointerId, x: event.clientX, y: event.clientY, camera};
  if (!camera) take();
  event.preventDefault();
});
picture.addEventListener("pointermove", (event) => {
  if (pointer === null || event.pointerId !== pointer.id) return;
  const height = picture.clientHeight;
  const right = (event.clientX - pointer.x) / height, up = (pointer.y - event.clientY) / height;
  pointer.x = event.clientX;
  pointer.y = event.clientY;
  if (pointer.camera) {
    orbit.yaw -= Math.PI * right;
    orbit.pitch -= Math.PI * up;
  } else if (event.shiftKey) {
    move.ry += Math.PI * right;
    move.rx -= Math.PI * up;
  } else {
    move.dx += right;
    move.dy += up;
  }
  schedule();
});
function release(event) {
  if (pointer === null || event.pointerId !== pointer.id) return;
  const camera = pointer.camera;
  pointer = null;
  if (!camera && $("let-go").checked) drop();
}
picture.addEventListener("pointerup", release);
picture.addEventListener("pointercancel", release);
picture.addEventListener("contextmenu", (event) => event.preventDefault());
picture.addEventListener("wheel", (event) => {
  if (!may_control) return;
  event.preventDefault();
  const unit = event.deltaMode === 0 ? 0.01 : 0.3;  // pixels, or lines
  const notches = Math.max(-5, Math.min(5, unit * (event.deltaY || event.deltaX)));  // Shift turns the wheel sideways in some browsers
  if (event.ctrlKey) {
    orbit.zoom *= 1.1 ** -notches;
  } else {
    nudge(event.shiftKey || event.altKey ? {rz: -0.08 * notches} : {dz: 0.015 * notches});
  }
  schedule();
}, {passive: false});

// Wheel and keys have no release: they let go a little after the last one.
function nudge(step) {
  take();
  for (const [axis, amount] of Object.entries(step)) move[axis] += amount;
  schedule();
  clearTimeout(wheel_timer);
  wheel_timer = setTimeout(() => {
    if (pointer === null && $("let-go").checked) drop();
  }, 900);
}

const moves = {ArrowLeft: {dx: -0.01}, ArrowRight: {dx: 0.01}, ArrowUp: {dy: 0.01}, ArrowDown: {dy: -0.01}, PageUp: {dz: -0.01}, PageDown: {dz: 0.01}};
const turns = {ArrowLeft: {ry: -0.04}, ArrowRight: {ry: 0.04}, ArrowUp: {rx: -0.04}, ArrowDown: {rx: 0.04}, PageUp: {rz: 0.04}, PageDown: {rz: -0.04}};
const looks = {ArrowLeft: {yaw: 0.06}, ArrowRight: {yaw: -0.06}, ArrowUp: {pitch: -0.06}, ArrowDown: {pitch: 0.06}, PageUp: {zoom: 1.1}, PageDown: {zoom: 1 / 1.1}};
picture.addEventListener("keydown", (event) => {
  if (!may_control) return;
  if (event.key === "Escape") {
    drop();
  } else if (event.ctrlKey && looks[event.key]) {
    orbit.yaw += looks[event.key].yaw || 0;
    orbit.pitch += looks[event.key].pitch || 0;
    orbit.zoom *= looks[event.key].zoom || 1;
    schedule();
  } else if (event.shiftKey && turns[event.key]) {
    nudge(turns[event.key]);
  } else if (moves[event.key] && !event.altKey) {
    nudge(moves[event.key]);
  } else {
    return;
  }
  event.preventDefault();
});
window.addEventListener("blur", () => {
  if (pointer !== null) release({pointerId: pointer.id});
});

connect();
