// SPDX-License-Identifier: Apache-2.0
// The console page: joins the board with its views.
import { Board } from './board';
import { BreakView } from './break_view';
import { DiagnoseView } from './diagnose_view';
import { byId, options } from './dom';
import { ExperimentView } from './experiment_view';
import { parseTables, type Status } from './knowledge';
import { LiveView } from './live_view';
import { MoveView } from './move_view';
import { ParameterView } from './parameter_view';
import { Safety } from './safety';
import { ScopeView } from './scope_view';
import { SerialLink, serialOfBrowser } from './serial_link';
import { ShellView } from './shell_view';
import { SimulatorLink } from './simulator_link';
import { SocketLink } from './socket_link';
import { StateView } from './state_view';
import { connectTabs } from './tabs';

const say = (text: string) => (byId('message').textContent = text);

const board: Board = new Board({
  status: (status) => show(status),
  schema: (schema) => live.schema(schema),
  sample: (tick, values) => live.sample(tick, values),
  remark: (text) => shell.show(text),
  connected: () => void connected(),
  lost: (why) => {
    if (why !== '') {
      window.setTimeout(() => say(why)); // after those whose answers it cut off have had their word
    }
  },
});
const live = new LiveView(board, say);
const states = new StateView(board);
const parameters = new ParameterView(board, say);
const move = new MoveView(board, say);
const experiments = new ExperimentView(board, live);
const served = document.querySelector('meta[name="capstan-served"]') !== null;
new DiagnoseView(board, served, { experiment: () => experiments.csv, live: () => live.csv() });
const scope = new ScopeView(board, live);
const breaking = new BreakView(board, (effects) => startSimulator(effects));
const shell = new ShellView(board);
const safety = new Safety(
  board,
  (text) => {
    say(text);
    states.happened(text);
  },
  (lines, error) => {
    say([...lines, error].join(' '));
    states.list(lines);
  },
);

function show(status: Status | undefined): void {
  states.show(status);
  move.show(status);
  safety.show(status !== undefined, board.mayHaveTorque);
}

async function connected(): Promise<void> {
  const simulated = board.link?.simulated === true;
  byId('tab-break').hidden = !simulated;
  if (!simulated && visible === 'break') {
    byId('tab-live').click();
  }
  parameters.forget();
  byId('take').hidden = !board.looking;
  if (board.looking) {
    say('another page commands this board; this one looks, and DISARM works');
    return;
  }
  if (!(await answers())) {
    return;
  }
  await live.connected();
  scope.connected();
  await board.askStatus();
  await experiments.connected(board.status?.joints.length ?? 1);
  if (simulated) {
    await breaking.connected(board.status?.joints.length ?? 1);
  }
  viewShown(visible);
  await compareVersions();
}

/** A board that still starts hears nothing: waits until it does. False if it is another board's turn meanwhile. */
async function answers(): Promise<boolean> {
  const { link } = board;
  while (board.link === link && (await board.ask('version')).error !== undefined);
  return board.link === link && !board.looking;
}

/** The page reads other versions too; what they named otherwise it cannot know. */
async function compareVersions(): Promise<void> {
  const theirs = /^capstan (\S+) board /.exec((await board.ask('version')).lines.join('\n'))?.[1];
  if (theirs !== undefined && theirs !== version) {
    say(`the board's firmware is version ${theirs}, this page is of ${version}: names may differ; use the page of that version, or flash the board`);
  }
}

let visible = '';
function viewShown(id: string): void {
  visible = id;
  if (id === 'parameters') void parameters.load();
  if (id === 'move') void move.load();
  if (id === 'states') void states.askFaults();
}
connectTabs(viewShown);

const simulator: SimulatorLink = new SimulatorLink(board.eventsOf(() => simulator));
const instrument = byId<HTMLSelectElement>('instrument');

/** Starts the simulated board anew; returns a sentence if that is not possible. */
async function startSimulator(effects: string): Promise<string> {
  if (board.link !== simulator) {
    await board.detach();
  }
  const problem = await simulator.start(`instrument = "${instrument.value}.toml"\n[effects]\n${effects}\n`);
  if (problem === '') {
    board.attach(simulator);
  }
  return problem;
}

/** The board behind the program that serves this page; choosing an instrument leaves it for the simulator. */
function connectServer(): void {
  const events = board.eventsOf(() => server);
  const server: SocketLink = new SocketLink({
    ...events,
    role: (looks) => {
      say('');
      board.attach(server, looks);
    },
    cancelled: () => board.link === server && board.shell.cancel(),
    remark: (text) => board.link === server && shell.show(text),
    lost: (why) => (board.link === server ? events.lost(why) : say(why)),
  });
  byId('take').addEventListener('click', () => server.askForCommand());
}

let version = '';
void simulator.tables.then(async (text) => {
  const tables = parseTables(text);
  board.safeStates = new Set(tables.states.filter((state) => !state.torque).map((state) => state.name));
  states.know(tables);
  breaking.know(tables);
  options(instrument, tables.instruments.map((one) => one.name));
  version = tables.version;
  instrument.disabled = false;
  if (served) {
    connectServer();
  } else {
    say(await startSimulator(''));
  }
});
instrument.addEventListener('change', () => void startSimulator('').then(say));
byId<HTMLSelectElement>('speed').addEventListener('change', (event) => simulator.setSpeed(Number((event.target as HTMLSelectElement).value)));

const serial = serialOfBrowser();
const serialButton = byId<HTMLButtonElement>('serial');
serialButton.hidden = serial === undefined;
/** A board on a serial line takes the simulator's place; choosing an instrument leads back. */
async function connectSerial(): Promise<void> {
  try {
    const port = await serial!.requestPort();
    await board.detach();
    const link = await SerialLink.open(port);
    say('a board on a serial line: real joints may move');
    board.attach(link);
    link.listen(board.eventsOf(() => link));
  } catch (problem) {
    say(problem instanceof Error ? problem.message : String(problem));
  }
}
serialButton.addEventListener('click', () => void connectSerial());
