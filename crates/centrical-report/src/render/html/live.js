"use strict";
// The panel comes from the server, which escapes what files say. What has not changed stays, with its focus and what is open.
const panel = document.getElementById("live");
const connection = document.getElementById("connection");
// The server sends every five seconds at least: after this time [s] it is lost, though the connection may still seem open.
const LONGEST_SILENCE = 12;
let received = performance.now();
let events, connected;

// Elements as they came: the script itself writes ages and times into them.
const sources = new WeakMap();

function take(markup) {
  const fresh = document.createElement("template");
  fresh.innerHTML = markup;
  exchange(panel, fresh.content);
  received = performance.now();
  tick();
}

function exchange(old, fresh) {
  const shown = Array.from(old.children), wanted = Array.from(fresh.children);
  const isAlike = shown.length === wanted.length && shown.every((child, n) => child.id === wanted[n].id && child.className === wanted[n].className);
  if (!isAlike) {
    wanted.forEach(remember);
    old.replaceChildren(...wanted);
    return;
  }
  shown.forEach((child, n) => {
    if (child.matches(".banners, .cards, .figures")) exchange(child, wanted[n]);
    else if (sources.get(child) !== wanted[n].outerHTML) {
      remember(wanted[n]);
      child.replaceWith(wanted[n]);
    }
  });
}

function remember(element) {
  sources.set(element, element.outerHTML);
  if (element.matches(".banners, .cards, .figures")) Array.from(element.children).forEach(remember);
}

function tick() {
  const now = performance.now(), passed = (now - received) / 1000;
  const isSilent = passed > LONGEST_SILENCE;
  connection.hidden = events.readyState === EventSource.OPEN && !isSilent;
  if (isSilent && (now - connected) / 1000 > LONGEST_SILENCE) connect();
  for (const age of panel.querySelectorAll("[data-age]")) {
    age.textContent = String(Math.round(Number(age.dataset.age) + passed));
  }
  for (const time of panel.querySelectorAll("time[data-seconds]")) {
    const date = new Date(1000 * Number(time.dataset.seconds));
    time.textContent = date.toLocaleTimeString(document.documentElement.lang, { hour: "2-digit", minute: "2-digit" });
  }
}

function connect() {
  events?.close();
  events = new EventSource("/events" + location.search);
  events.onmessage = event => take(event.data);
  connected = performance.now();
}

Array.from(panel.children).forEach(remember);
connect();
setInterval(tick, 500);
