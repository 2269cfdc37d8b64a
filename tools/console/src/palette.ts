// SPDX-License-Identifier: Apache-2.0
// Colours after M. Okabe and K. Ito, which people with any colour vision tell apart; each also has a dash of its own.

export interface Stroke {
  colour: string;
  dash: number[];
}
const kLight = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#000000', '#b08600', '#3a9bd1', '#6a3d9a'];
const kDark = ['#56b4e9', '#e69f00', '#00c090', '#e59cc6', '#ffffff', '#f0e442', '#8fb8ff', '#c3a5ff'];
const kDashes = [[], [9, 4], [3, 3], [12, 4, 3, 4], [], [6, 2], [2, 5], [14, 6]];

export function dark(): boolean {
  return window.matchMedia('(prefers-color-scheme: dark)').matches;
}
export function stroke(number: number): Stroke {
  const colours = dark() ? kDark : kLight;
  return { colour: colours[number % colours.length]!, dash: kDashes[number % kDashes.length]! };
}
/** A colour of style.css. */
export function themed(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
