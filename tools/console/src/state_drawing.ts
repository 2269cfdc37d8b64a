// SPDX-License-Identifier: Apache-2.0
// The firmware's table of states as a drawing: those with torque in a box of their own. What all of them share is one arrow.
import { draw } from './dom';
import type { Tables } from './knowledge';

const kWidth = 620;
/** How much lower the arrow that all states with torque share ends than the others. */
const kShared = 8;
const kBox = { width: 110, height: 34 };

interface Place {
  x: number;
  y: number;
}

/** States without torque stand in a column on the left, where it begins at the top; the others on a ring on the right. */
function places({ states, transitions }: Tables): Map<string, Place> {
  const at = new Map<string, Place>();
  const entered = (name: string) => Number(transitions.some((row) => row.to === name));
  const without = states.filter((state) => !state.torque).sort((a, b) => entered(a.name) - entered(b.name));
  const torque = states.filter((state) => state.torque);
  without.forEach((state, i) => at.set(state.name, { x: 70, y: 60 + (i * 220) / Math.max(1, without.length - 1) }));
  torque.forEach((state, i) => {
    const angle = Math.PI + (2 * Math.PI * i) / torque.length;
    at.set(state.name, { x: 435 + 120 * Math.cos(angle), y: 170 + 120 * Math.sin(angle) });
  });
  return at;
}

/** From edge to edge of two boxes. */
function arrow(from: Place, to: Place): string {
  const edge = (a: Place, b: Place): Place => {
    const [dx, dy] = [b.x - a.x, b.y - a.y];
    const share = Math.min(Math.abs((kBox.width / 2 + 3) / (dx || 1e-9)), Math.abs((kBox.height / 2 + 3) / (dy || 1e-9)));
    return { x: a.x + dx * share, y: a.y + dy * share };
  };
  const [a, b] = [edge(from, to), edge(to, from)];
  const bend = { x: (a.x + b.x) / 2 + (b.y - a.y) * 0.12, y: (a.y + b.y) / 2 - (b.x - a.x) * 0.12 };
  return `M${a.x.toFixed(1)} ${a.y.toFixed(1)}Q${bend.x.toFixed(1)} ${bend.y.toFixed(1)} ${b.x.toFixed(1)} ${b.y.toFixed(1)}`;
}

export function drawStates(tables: Tables): SVGElement {
  const svg = draw('svg', { viewBox: `0 0 ${kWidth} 340`, role: 'img', 'aria-label': 'table of states' });
  const marker = draw('marker', { id: 'tip', viewBox: '0 0 8 8', refX: 7, refY: 4, markerWidth: 8, markerHeight: 8, orient: 'auto' });
  marker.append(draw('path', { d: 'M0 0L8 4L0 8z' }));
  svg.append(marker);
  const at = places(tables);
  const torque = tables.states.filter((state) => state.torque).map((state) => state.name);
  const shared = (trigger: string, to: string) => torque.every((from) => tables.transitions.some((row) => row.from === from && row.trigger === trigger && row.to === to));
  svg.append(draw('rect', { class: 'group', x: 240, y: 20, width: 372, height: 304, rx: 8 }), draw('text', { class: 'label', x: 580, y: 40 }, 'torque on'));
  const drawn = new Set<string>();
  for (const { from, trigger, to } of tables.transitions) {
    const all = torque.includes(from) && shared(trigger, to);
    const key = all ? `all ${to}` : `${from} ${to}`;
    if (!drawn.has(key)) {
      drawn.add(key);
      const end = at.get(to)!;
      svg.append(draw('path', { d: all ? `M240 ${end.y + kShared}L${end.x + kBox.width / 2 + 3} ${end.y + kShared}` : arrow(at.get(from)!, end), 'marker-end': 'url(#tip)' }));
      if (all || !torque.includes(from)) {
        const start = all ? { x: 240, y: end.y } : at.get(from)!;
        svg.append(draw('text', { class: 'label', x: all ? 180 : (start.x + end.x) / 2 + 34, y: (start.y + end.y) / 2 + (all ? kShared + 13 : end.x > start.x ? -17 : 4) }, trigger));
      }
    }
  }
  for (const { name } of tables.states) {
    const { x, y } = at.get(name)!;
    const group = draw('g', { 'data-state': name });
    group.append(draw('rect', { x: x - kBox.width / 2, y: y - kBox.height / 2, ...kBox, rx: 5 }), draw('text', { x, y: y + 5 }, name));
    svg.append(group);
  }
  return svg;
}
