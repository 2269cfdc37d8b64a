// SPDX-License-Identifier: Apache-2.0
// Where the machine is, what is wrong with it, and what happened.
import type { Board } from './board';
import { byId, make } from './dom';
import { parseFaults, type Status, type Tables } from './knowledge';
import { drawStates } from './state_drawing';

const kMostEvents = 100;
const kFaultsEveryMs = 600;

export class StateView {
  private tables: Tables | undefined;
  private last = '';
  private asked = 0;

  constructor(private readonly board: Board) {}

  know(tables: Tables): void {
    this.tables = tables;
    byId('machine').replaceChildren(drawStates(tables));
    byId('fault-table').querySelector('tbody')!.replaceChildren(
      ...tables.faults.filter((fault) => fault.number !== 0).map((fault) =>
        make('tr', {}, make('td', {}, String(fault.number)), make('th', { scope: 'row' }, fault.name), make('td', {}, fault.cause), make('td', {}, fault.cure)),
      ),
    );
  }

  happened(text: string): void {
    for (const events of document.querySelectorAll('.events')) {
      events.prepend(make('li', {}, `${new Date().toLocaleTimeString()}: ${text}`));
      while (events.children.length > kMostEvents) {
        events.lastChild!.remove();
      }
    }
  }

  show(status: Status | undefined): void {
    const state = status?.state ?? '';
    const words = status === undefined ? 'not connected' : `${state}${status.fault === 'none' ? '' : ` by ${status.fault}`}`;
    if (words !== this.last) {
      this.last = words;
      this.happened(words);
      this.mark(state, words, status);
    }
    if (status !== undefined && performance.now() - this.asked > kFaultsEveryMs && !(byId('states').hidden && byId('break').hidden)) {
      this.asked = performance.now();
      void this.askFaults();
    }
  }

  private mark(state: string, words: string, status: Status | undefined): void {
    const box = byId('state');
    box.textContent = words;
    const torque = this.board.mayHaveTorque;
    box.dataset['kind'] = status === undefined ? '' : status.fault !== 'none' ? 'fault' : torque ? 'torque' : 'safe';
    byId('machine').querySelectorAll('g').forEach((group) => group.classList.toggle('here', group.getAttribute('data-state') === state));
    const ways = this.tables?.transitions.filter((row) => row.from === state) ?? [];
    byId('state-words').textContent =
      state === '' ? '' : `Now ${state}. ${torque ? 'The joints have torque. ' : 'No torque. '}${ways.map((row) => `On ${row.trigger}: ${row.to}.`).join(' ')}`;
  }

  async askFaults(): Promise<void> {
    const answer = await this.board.ask('faults');
    if (answer.error === undefined) {
      this.list(answer.lines);
    }
  }

  /** What is latched and what blocks arming. */
  list(lines: string[]): void {
    for (const list of document.querySelectorAll('.faults')) {
      list.replaceChildren(
        ...parseFaults(lines).map((fault) =>
          fault.kind === '' || fault.name === 'none'
            ? make('li', {}, fault.name === 'none' ? 'nothing is latched' : fault.cause)
            : make('li', {}, make('strong', {}, `${fault.kind} ${fault.name}`), `: ${fault.cause}. To do: ${fault.cure}`),
        ),
      );
    }
  }
}
