// SPDX-License-Identifier: Apache-2.0
// What a board says of itself, read from its shell's answers. Nothing here is known beforehand but the form of the answers.

export interface JointStatus {
  name: string;
  text: string;
  angleRad: number;
}
export interface Status {
  state: string;
  fault: string;
  cycles: number;
  joints: JointStatus[];
}

export function parseStatus(lines: string[]): Status | undefined {
  const head = /^state (\S+) fault (\S+) cycles (\d+)/.exec(lines[0] ?? '');
  if (head === null) {
    return undefined;
  }
  const joints: JointStatus[] = [];
  for (const line of lines.slice(1)) {
    const joint = /^(joint\d+) (.*? joint (-?[\d.e+-]+) rad.*)$/.exec(line);
    if (joint !== null) {
      joints.push({ name: joint[1]!, text: joint[2]!, angleRad: Number(joint[3]) });
    }
  }
  return { state: head[1]!, fault: head[2]!, cycles: Number(head[3]), joints };
}

export interface Signal {
  name: string;
  unit: string;
  meaning: string;
}

/** Lines of `scope signals`. */
export function parseSignals(lines: string[]): Signal[] {
  return lines.flatMap((line) => {
    const found = /^(\S+\.\S+) (\S+) (.*)$/.exec(line);
    return found === null ? [] : [{ name: found[1]!, unit: found[2] === '1' ? '' : found[2]!, meaning: found[3]! }];
  });
}

export interface Parameter {
  joint: string;
  /** group.name */
  name: string;
  value: string;
  unit: string;
  low: string;
  high: string;
  meaning: string;
  /** From `help`; empty until asked for. */
  fallback: string;
  when: string;
}

const kListed = /^(joint\d+)\.(\w+\.\w+) (\S+)(?: (\S+))? \((\S+) to (\S+)(?: \S+)?\) ?(.*)$/;

/** Lines of `list`. */
export function parseParameters(lines: string[]): Parameter[] {
  return lines.flatMap((line) => {
    const found = kListed.exec(line);
    if (found === null) {
      return [];
    }
    const [, joint, name, value, unit, low, high, meaning] = found;
    return [{ joint: joint!, name: name!, value: value!, unit: unit ?? '', low: low!, high: high!, meaning: meaning!, fallback: '', when: '' }];
  });
}

/** Full names and values, with their units, of lines `set NAME VALUE`. */
export function valuesOf(lines: string[]): Map<string, string> {
  return new Map(lines.flatMap((line) => {
    const found = /^set (\S+) (.*)$/.exec(line);
    return found === null ? [] : [[found[1]!, found[2]!] as const];
  }));
}

/** Adds what `help GROUP` says: default, and when a parameter may change. */
export function addHelp(parameters: Parameter[], lines: string[]): void {
  for (let i = 0; i + 1 < lines.length; ++i) {
    const head = /^ *(\w+\.\w+): /.exec(lines[i]!);
    const body = /, default (\S+)(?: [^,]*)?, (changes .*)$/.exec(lines[i + 1]!);
    if (head !== null && body !== null) {
      for (const parameter of parameters.filter((one) => one.name === head[1])) {
        parameter.fallback = body[1]!;
        parameter.when = body[2]!;
      }
    }
  }
}

export interface FaultLine {
  /** `latched`, `present`, `last` and so on. */
  kind: string;
  name: string;
  cause: string;
  cure: string;
}

/** Lines of `faults`, and those above the refusal of `arm`. */
export function parseFaults(lines: string[]): FaultLine[] {
  return lines.map((line) => {
    const found = /^(latched|present|warning|blocked by) (\w+): ([^;]*); (.*)$/.exec(line);
    return found === null
      ? { kind: '', name: '', cause: line, cure: '' }
      : { kind: found[1]!, name: found[2]!, cause: found[3]!, cure: found[4]! };
  });
}

/** `known are: a, b, c` of a refusal. */
export function parseKnown(refusal: string): string[] {
  const found = /known are: (.*)$/.exec(refusal);
  return found === null ? [] : found[1]!.split(', ');
}

export interface Tables {
  version: string;
  states: { name: string; torque: boolean }[];
  transitions: { from: string; trigger: string; to: string }[];
  faults: { number: number; name: string; cause: string; cure: string }[];
  instruments: { name: string; axes: number }[];
  effects: { effect: string; field: string; low: number; high: number; primary: boolean }[];
}

/** The tables of boards/browser/tables.hpp. */
export function parseTables(text: string): Tables {
  const tables: Tables = { version: '', states: [], transitions: [], faults: [], instruments: [], effects: [] };
  for (const [kind, a = '', b = '', c = '', d = '', e = ''] of text.split('\n').map((line) => line.split('\t'))) {
    if (kind === 'version') tables.version = a;
    if (kind === 'state') tables.states.push({ name: a, torque: b === '1' });
    if (kind === 'transition') tables.transitions.push({ from: a, trigger: b, to: c });
    if (kind === 'fault') tables.faults.push({ number: Number(a), name: b, cause: c, cure: d });
    if (kind === 'instrument') tables.instruments.push({ name: a, axes: Number(b) });
    if (kind === 'effect') tables.effects.push({ effect: a, field: b, low: Number(c), high: Number(d), primary: e === '1' });
  }
  return tables;
}
