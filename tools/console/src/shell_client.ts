// SPDX-License-Identifier: Apache-2.0
// Asks a board's shell: one line at a time, and each waits for its answer. DISARM waits for nothing.

export interface Answer {
  lines: string[];
  /** `name: sentence; cure` of a refusal. */
  error?: string;
}

interface Question {
  line: string;
  heard: ((line: string) => void) | undefined;
  resolve(answer: Answer): void;
}

const kPatienceMs = 5000; // saving erases flash, which takes up to 2.6 s
const kQuietMs = 60;
const kMostWaiting = 2000;
const kMostOverheard = 100;
const kPrompt = 'capstan> ';
const kCancel = '\x03';
/** Its answer is like no other, so it tells where an interrupted talk begins again. */
const kResync = 'version';
const kResyncAnswer = /^capstan \S+ board /;

export class ShellClient {
  /** What the board says by itself. */
  onRemark: (line: string) => void = () => undefined;
  /** An answer to a question that somebody else asked. */
  onOverheard: (lines: string[]) => void = () => undefined;
  private readonly waiting: Question[] = [];
  private asked: Question | undefined;
  private lines: string[] = [];
  private rest = '';
  private timer = 0;
  /** After an interruption: what comes before the answer to kResync belongs to nobody. */
  private resync: 'no' | 'waits' | 'answered' = 'no';

  constructor(private readonly write: (text: string) => void) {}

  get busy(): boolean {
    return this.asked !== undefined || this.waiting.length > 0 || this.resync !== 'no';
  }

  /** @param heard  is told every line of the answer as it comes */
  ask(line: string, heard?: (line: string) => void): Promise<Answer> {
    return new Promise((resolve) => {
      if (this.waiting.length >= kMostWaiting) {
        resolve({ lines: [], error: 'busy: too many lines wait for their answer; wait for the board' });
        return;
      }
      this.waiting.push({ line, heard, resolve });
      this.next();
    });
  }

  /** Takes the torque away whatever is under way: nothing waits before it, and what waited is forgotten. */
  disarm(): void {
    this.interrupt('disarm');
  }
  /** Ends what streams. */
  cancel(): void {
    this.interrupt('');
  }
  /** The line is gone: nobody answers any more. */
  lost(): void {
    this.forget('line: the line to the board is gone; connect again');
    this.resync = 'no';
    window.clearTimeout(this.timer);
  }

  receive(text: string): void {
    const parts = (this.rest + text).split('\n');
    this.rest = parts.pop()!;
    for (const part of parts) {
      this.take(part.replace(/\r+$/, ''));
    }
  }

  private interrupt(line: string): void {
    this.forget('interrupted: something urgent came first, and whether this was done is not known; look at the state');
    this.write(`${kCancel}${line === '' ? '' : `${line}\n`}${kResync}\n`);
    this.resync = 'waits';
    this.patience();
  }

  private forget(error: string): void {
    const all = this.asked === undefined ? [...this.waiting] : [this.asked, ...this.waiting];
    this.asked = undefined;
    this.waiting.length = 0;
    this.lines = [];
    for (const question of all) {
      question.resolve({ lines: [], error });
    }
  }

  private next(): void {
    if (this.asked !== undefined || this.resync !== 'no') {
      return;
    }
    this.asked = this.waiting.shift();
    if (this.asked !== undefined) {
      this.lines = [];
      this.write(`${this.asked.line}\n`);
      this.patience();
    }
  }

  private patience(): void {
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      this.onRemark('# no answer within 5 s; check that a board is connected and that no other program uses its shell');
      this.interrupt('');
    }, kPatienceMs);
  }

  private take(raw: string): void {
    let line = raw;
    while (line.startsWith(kPrompt)) {
      line = line.slice(kPrompt.length);
    }
    if (line.startsWith('# ')) {
      this.onRemark(line);
      return;
    }
    if (this.resync !== 'no') {
      this.takeResync(line);
    } else if (this.asked !== undefined && line !== this.asked.line) {
      this.takeAnswer(this.asked, line);
    } else if (this.asked === undefined) {
      this.overhear(line);
    }
  }

  private overhear(line: string): void {
    if (line === 'ok' || line.startsWith('error ')) {
      this.onOverheard(this.lines);
      this.lines = [];
    } else {
      this.lines = [...this.lines.slice(1 - kMostOverheard), line];
    }
  }

  private takeResync(line: string): void {
    if (kResyncAnswer.test(line)) {
      this.resync = 'answered';
    }
    if (this.resync === 'answered') {
      // Of two interruptions one answer may be forgotten, so it is silence that ends this.
      window.clearTimeout(this.timer);
      this.timer = window.setTimeout(() => {
        this.resync = 'no';
        this.next();
      }, kQuietMs);
    }
  }

  private takeAnswer(question: Question, line: string): void {
    const error = line.startsWith('error ') ? line.slice('error '.length) : undefined;
    if (line !== 'ok' && error === undefined) {
      this.lines.push(line);
      question.heard?.(line);
      this.patience();
      return;
    }
    window.clearTimeout(this.timer);
    this.asked = undefined;
    question.resolve(error === undefined ? { lines: this.lines } : { lines: this.lines, error });
    this.next();
  }
}
