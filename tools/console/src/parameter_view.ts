// SPDX-License-Identifier: Apache-2.0
// Every parameter of the board with what it means; edits are staged here and taken by the board all or none.
import type { Board } from './board';
import { byId, download, make, options } from './dom';
import { addHelp, parseParameters, type Parameter } from './knowledge';

const kMostCommits = 50;

/** A commit of this page, so that it can be taken back. */
type Commit = { name: string; before: string; after: string }[];

function full(parameter: Parameter): string {
  return `${parameter.joint}.${parameter.name}`;
}

export class ParameterView {
  private parameters: Parameter[] = [];
  private readonly staged = new Map<string, string>();
  private readonly refusals = new Map<string, string>();
  private readonly rows = new Map<string, HTMLTableRowElement>();
  private readonly commits: Commit[] = [];
  private loading: Promise<void> | undefined;
  private taking = false;
  private readonly joint = byId<HTMLSelectElement>('parameter-joint');
  private readonly search = byId<HTMLInputElement>('search');
  private readonly changedOnly = byId<HTMLInputElement>('changed-only');

  constructor(
    private readonly board: Board,
    private readonly say: (text: string) => void,
  ) {
    for (const element of [this.joint, this.search, this.changedOnly]) {
      element.addEventListener('input', () => this.filter());
    }
    byId('commit').addEventListener('click', () => void this.commit());
    byId('undo').addEventListener('click', () => void this.undo());
    byId('forget').addEventListener('click', () => this.forgetEdits());
    byId('save').addEventListener('click', () => void this.save());
    byId('diff').addEventListener('click', () => void this.saveDifferences());
    byId('maintenance').addEventListener('click', () => void this.openMaintenance());
  }

  /** Another board may be there now. */
  forget(): void {
    this.parameters = [];
    this.staged.clear();
    this.refusals.clear();
    this.commits.length = 0;
    this.build();
  }

  find(name: string): Parameter | undefined {
    return this.parameters.find((one) => full(one) === name);
  }

  /** Reads all of them once, and afterwards their values again: others change them too. */
  load(): Promise<void> {
    this.loading ??= (this.parameters.length > 0 ? this.look() : this.read()).finally(() => (this.loading = undefined));
    return this.loading;
  }

  private async read(): Promise<void> {
    const answer = await this.board.lookUp('list');
    const parameters = parseParameters(answer.lines);
    const groups = new Set(parameters.map((one) => one.name.split('.')[0]!));
    for (const group of groups) {
      addHelp(parameters, (await this.board.lookUp(`help ${group}`)).lines);
    }
    this.parameters = parameters;
    const joints = [...new Set(parameters.map((one) => one.joint))];
    options(this.joint, joints, joints.includes(this.joint.value) ? this.joint.value : joints[0]);
    this.build();
    this.say(answer.error ?? '');
  }

  private build(): void {
    this.rows.clear();
    for (const parameter of this.parameters) {
      this.rows.set(full(parameter), this.row(parameter));
    }
    byId('parameter-table').querySelector('tbody')!.replaceChildren(...this.rows.values());
    this.filter();
    this.mark();
  }

  private row(parameter: Parameter): HTMLTableRowElement {
    const name = full(parameter);
    const input = make('input', {
      type: 'text',
      inputmode: 'decimal',
      'aria-label': name,
      input: () => this.stage(parameter, input.value),
    });
    const refusal = make('span', { class: 'refusal', role: 'status' });
    const meaning = make('td', {}, parameter.meaning, make('span', { class: 'hint' }, parameter.when === '' ? '' : ` (${parameter.when})`));
    return make(
      'tr',
      { 'data-name': name },
      make('th', { scope: 'row' }, parameter.name),
      make('td', {}, input, refusal),
      make('td', {}, parameter.unit),
      make('td', { class: 'range' }, `${parameter.low} to ${parameter.high}`),
      make('td', {}, parameter.fallback),
      meaning,
    );
  }

  private stage(parameter: Parameter, text: string): void {
    const name = full(parameter);
    this.refusals.delete(name);
    this.staged.delete(name); // the last one edited stands last
    if (text.trim() !== parameter.value) {
      this.staged.set(name, text.trim());
    }
    this.markRow(parameter, false);
    this.count();
  }

  private filter(): void {
    const words = this.search.value.toLowerCase().split(/\s+/);
    for (const parameter of this.parameters) {
      const text = `${parameter.name} ${parameter.meaning}`.toLowerCase();
      const changed = parameter.value !== parameter.fallback || this.staged.has(full(parameter));
      this.rows.get(full(parameter))!.hidden =
        parameter.joint !== this.joint.value || !words.every((word) => text.includes(word)) || (this.changedOnly.checked && !changed);
    }
  }

  private mark(): void {
    this.parameters.forEach((parameter) => this.markRow(parameter, true));
    this.count();
  }
  private markRow(parameter: Parameter, withText: boolean): void {
    const name = full(parameter);
    const row = this.rows.get(name)!;
    row.classList.toggle('changed', parameter.fallback !== '' && parameter.value !== parameter.fallback);
    row.classList.toggle('staged', this.staged.has(name));
    row.classList.toggle('refused', this.refusals.has(name));
    row.querySelector('.refusal')!.textContent = this.refusals.get(name) ?? '';
    if (withText) {
      row.querySelector('input')!.value = this.staged.get(name) ?? parameter.value;
    }
  }
  private count(): void {
    const count = this.staged.size;
    byId('staged').textContent = count === 0 ? '' : `${count} staged, not on the board yet`;
    byId<HTMLButtonElement>('commit').disabled = byId<HTMLButtonElement>('forget').disabled = count === 0;
    byId<HTMLButtonElement>('undo').disabled = count === 0 && this.commits.length === 0;
    byId('undo').textContent = count === 0 ? 'Undo last commit' : 'Undo last edit';
  }

  private forgetEdits(): void {
    this.staged.clear();
    this.refusals.clear();
    this.mark();
    this.filter();
  }

  /** Takes back the last edit; where there is none, the last commit, on the board. */
  private async undo(): Promise<void> {
    const name = [...this.staged.keys()].at(-1);
    if (name === undefined) {
      this.say(await this.undoCommit());
      return;
    }
    this.staged.delete(name);
    this.refusals.delete(name);
    this.mark();
    this.filter();
  }

  /** Takes the last commit back on the board; resolves to what became of it. */
  async undoCommit(): Promise<string> {
    const last = this.commits.at(-1);
    if (last === undefined) {
      return 'nothing was committed from this page yet';
    }
    await this.look();
    const changed = last.find((one) => this.find(one.name)?.value !== one.after);
    if (changed !== undefined) {
      this.commits.pop();
      this.mark();
      return `${changed.name} was changed since then by another way, so that commit is not taken back; edit the values here`;
    }
    const refusal = await this.put(new Map(last.map((one) => [one.name, one.before])));
    if (refusal !== undefined) {
      return refusal;
    }
    this.commits.pop();
    await this.look();
    return `taken back: ${last.map((one) => `${one.name} is ${one.before} again`).join(', ')}; save to keep that over a restart`;
  }

  /** Gives the board these values by their full names, all or none; they can be undone. Resolves to why nothing was changed. */
  async take(values: ReadonlyMap<string, string>): Promise<string | undefined> {
    await this.load();
    const before = new Map([...values.keys()].map((name) => [name, this.find(name)?.value ?? '']));
    const refusal = await this.put(values);
    if (refusal === undefined) {
      for (const name of values.keys()) {
        this.staged.delete(name);
      }
      await this.look();
      const commit = [...before].map(([name, old]) => ({ name, before: old, after: this.find(name)?.value ?? '' })).filter((one) => one.before !== one.after);
      if (commit.length > 0) {
        this.commits.push(commit);
        this.commits.splice(0, this.commits.length - kMostCommits);
        this.count();
      }
    }
    return refusal;
  }

  private async commit(): Promise<void> {
    const refusal = await this.take(new Map(this.staged));
    this.mark();
    this.filter();
    this.say(refusal ?? 'taken; save them to keep them over a restart');
  }

  /** All or none: whatever is refused, the board keeps what it had. */
  private async put(values: ReadonlyMap<string, string>): Promise<string | undefined> {
    if (this.taking) {
      return 'the board is still taking values; wait for it';
    }
    this.taking = true;
    this.refusals.clear();
    let refusal = (await this.board.ask('begin')).error;
    if (refusal === undefined) {
      for (const [name, value] of values) {
        const error = (await this.board.ask(`set ${name} ${value}`)).error;
        if (error !== undefined) {
          this.refusals.set(name, error);
        }
      }
      const why = [...this.refusals.values()][0] ?? '';
      refusal = this.refusals.size > 0 ? `${this.refusals.size} refused, and nothing was changed: ${why}` : (await this.board.ask('commit')).error;
      if (refusal !== undefined) {
        await this.board.ask('abandon');
        this.blame(values.keys(), refusal);
      }
    }
    this.taking = false;
    return refusal;
  }

  /** Some of a set are refused at its commit only; the sentence names them. */
  private blame(names: Iterable<string>, refusal: string): void {
    for (const name of names) {
      if (!this.refusals.has(name) && refusal.includes(`${name.slice(name.indexOf('.') + 1)} `)) {
        this.refusals.set(name, refusal);
      }
    }
  }

  /** What the board has now. */
  private async look(): Promise<void> {
    for (const now of parseParameters((await this.board.ask('list')).lines)) {
      const known = this.find(full(now));
      if (known !== undefined) {
        known.value = now.value;
      }
    }
    this.mark();
    this.filter();
  }

  private async save(): Promise<void> {
    this.say((await this.board.ask('save')).error ?? (this.board.link?.simulated === true ? 'saved; a simulated board forgets it when the page is left' : 'saved'));
  }
  private async saveDifferences(): Promise<void> {
    const answer = await this.board.ask('diff');
    if (answer.error === undefined) {
      download('capstan_parameters.txt', [`${answer.lines.join('\n')}\n`], 'text/plain');
    }
    this.say(answer.error ?? '');
  }
  private async openMaintenance(): Promise<void> {
    const key = byId<HTMLInputElement>('key');
    const answer = await this.board.ask(`maintenance open ${key.value}`.trim());
    key.value = '';
    this.say(answer.error ?? 'safety limits may be changed for ten minutes');
  }
}
