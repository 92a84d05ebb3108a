// Adds behaviour to a page that can be read without it.

import { Clock } from "./clock.js";
import { decode } from "./codec.js";
import { linkFigures } from "./figures.js";
import { linkEngines } from "./highlight.js";
import { buildPlayer } from "./player.js";
import { linkTables } from "./tables.js";
import { linkTips } from "./tips.js";

async function start() {
  linkTables();
  const say = linkTips();
  const data = document.getElementById("playback");
  const place = document.getElementById("player");
  /** @type {(engine: string | null) => void} */
  let highlight = () => {};
  const playback = data && place ? JSON.parse(data.textContent ?? "") : null;
  const clock = playback ? new Clock(playback.t) : null;
  linkFigures(clock, say);
  if (place && clock) {
    try {
      const player = buildPlayer(place, await decode(playback), clock);
      highlight = player.highlight;
      Object.assign(window, { springcheckPlayer: player });
    } catch (error) {
      place.textContent = `The motion cannot be played: ${error instanceof Error ? error.message : error}`;
    }
  }
  linkEngines((engine) => highlight(engine));
  document.documentElement.dataset.ready = "";
}

start();
