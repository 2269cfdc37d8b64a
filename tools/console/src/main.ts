// SPDX-License-Identifier: Apache-2.0
// The console page: joins the board with its views.
import { Board } from './board';
import { BreakView } from './break_view';
import { CommissionView } from './commission_view';
import { DiagnoseView } from './diagnose_view';
import { byId, options } from './dom';
import { ExperimentView } from './experiment_view';
import { parseTables, type Status } from './knowledge';
import { LiveView } from './live_view';
import { MoveView } from './move_view';
import { ParameterView } from './parameter_view';
import { ResponseView } from './response_view';
import { Safety } from './safety';
import { ScopeView } from './scope_view';
import { SerialLink, serialOfBrowser } from './serial_link';
import { ShellView } from './shell_view';
import { SimulatorLink } from './simulator_link';
import { SocketLink } from './socket_link';
import { StateView } from './state_view';
import { TuneView } from './tune_view';
import { connectTabs } from './tabs';

const say = (text: string) => (byId('message').textContent = text);

const board: Board = new Board({
  status: (status) => show(status),
  schema: (schema) => live.schema(schema),
  sample: (tick, values) => {
    live.sample(tick, values);
    response.sample(tick, values);
  },
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
const response = new ResponseView(board, live, parameters);
const experiments = new ExperimentView(board, live);
const served = document.querySelector('meta[name="capstan-served"]') !== null;
const tuning = new TuneView(board, served, live, parameters);
let socket: SocketLink | undefined;
const commissioning = new CommissionView(board, () => (board.link === socket ? socket : undefined), served, () => live.standBack());
const diagnosing = new DiagnoseView(board, served, parameters, { experiment: () => experiments.csv, live: () => live.csv() });
const scope = new ScopeView(board, live);
const breaking = new BreakView(board, (effect) => startAnew(effect));
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
  response.show(status);
  safety.show(status !== undefined, board.mayHaveTorque);
}

/** Joints that are programs can be broken: those of this page, and behind capstan console those of boards that say so by their names. */
function showBreaking(broken: boolean): void {
  byId('tab-break').hidden = !broken;
  if (!broken && visible === 'break') {
    byId('tab-live').click();
  }
}

async function connected(): Promise<void> {
  const own = board.link?.simulated === true;
  parameters.forget();
  byId('take').hidden = !board.looking || board.guided;
  if (board.looking) {
    showBreaking(false);
    say(board.guided ? 'capstan commission commands this board; DISARM ends it' : 'another page commands this board; this one looks, and DISARM works');
    return;
  }
  const [theirs, kind] = await answers();
  if (theirs === undefined) {
    return;
  }
  const simulated = own || (board.link === socket && (kind === 'sim' || kind.endsWith('-emulated')));
  showBreaking(simulated);
  await live.connected();
  scope.connected();
  await board.askStatus();
  await experiments.connected(board.status?.joints.length ?? 1);
  if (simulated) {
    await breaking.connected(board.status?.joints.length ?? 1, own || socket?.startsAnew === true);
  }
  viewShown(visible);
  compareVersions(theirs);
}

/** A board that still starts hears nothing: waits until it does. Its version and kind; no version if it is another board's turn meanwhile. */
async function answers(): Promise<[string | undefined, string]> {
  const { link } = board;
  for (;;) {
    const { lines, error } = await board.ask('version');
    if (board.link !== link || board.looking) {
      return [undefined, ''];
    }
    if (error === undefined) {
      const [, theirs = '', kind = ''] = /^capstan (\S+) board (\S+)/.exec(lines.join('\n')) ?? [];
      return [theirs, kind];
    }
  }
}

/** The page reads other versions too; what they named otherwise it cannot know. */
function compareVersions(theirs: string): void {
  if (theirs !== '' && theirs !== version) {
    say(`the board's firmware is version ${theirs}, this page is of ${version}: names may differ; use the page of that version, or flash the board`);
  }
}

let visible = '';
function viewShown(id: string): void {
  visible = id;
  if (id === 'parameters') void parameters.load();
  if (id === 'move') void move.load().then(() => response.load());
  else response.leave();
  if (id === 'setup') {
    tuning.load();
    commissioning.load();
  }
  if (id === 'diagnose') diagnosing.load();
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

/** The simulated board that is connected, with an effect ("play=0.03") or without; returns a sentence if that is not possible. */
function startAnew(effect: string): Promise<string> {
  return socket !== undefined && board.link === socket ? socket.startAnew(effect) : startSimulator(effect);
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
    commission: (words) => commissioning.hear(words),
    lost: (why) => {
      commissioning.lost();
      (board.link === server ? events.lost : say)(why);
    },
  });
  socket = server;
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
byId('speed').parentElement!.hidden = served; // it is the page's own simulator's

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
