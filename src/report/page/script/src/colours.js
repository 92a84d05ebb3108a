// Colours of the 3D picture, as pixels (0xAABBGGRR).

import { mix } from "./raster.js";

/**
 * @param {string} text `#rrggbb`
 * @param {boolean} dark turns light to dark and keeps the hue, as the style sheet's `invert(.93) hue-rotate(180deg)` does
 */
export function pixel(text, dark = false) {
  const value = parseInt(text.slice(1), 16);
  let rgb = [value >> 16, (value >> 8) & 255, value & 255];
  if (dark) {
    const [r, g, b] = rgb.map((part) => 0.93 * 255 - 0.86 * part);
    // The matrix of hue-rotate(180deg) in CSS's filter effects.
    rgb = [
      -0.574 * r + 1.43 * g + 0.144 * b,
      0.426 * r + 0.43 * g + 0.144 * b,
      0.426 * r + 1.43 * g - 0.856 * b,
    ].map((part) => Math.round(Math.max(0, Math.min(255, part))));
  }
  return ((255 << 24) | (rgb[2] << 16) | (rgb[1] << 8) | rgb[0]) >>> 0;
}

/** Short, at rest, long: apart for colour-blind eyes too. */
export const STRAIN = ["#0072b2", "#c8c8c8", "#d55e00"];

/** Steps of the strain's scale, an odd number: the middle one is at rest. */
export const STEPS = 65;

/** @param {boolean} dark @returns {Uint32Array} */
export function strainScale(dark) {
  const [short, still, long] = STRAIN.map((text) => pixel(text, dark));
  const half = (STEPS - 1) / 2;
  return Uint32Array.from({ length: STEPS }, (_, i) => {
    const part = (i - half) / half;
    // The root lets small strains be seen.
    return mix(still, part < 0 ? short : long, Math.sqrt(Math.abs(part)));
  });
}

/** The step for a strain. @param {number} strain @param {number} most the strain at the scale's end */
export function strainStep(strain, most) {
  const part = Math.max(-1, Math.min(1, strain / most));
  return Math.round(((part + 1) / 2) * (STEPS - 1)) || 0;
}
