// SPDX-License-Identifier: Apache-2.0
// What build.mjs puts in.
declare module 'capstan.wasm' {
  const bytes: Uint8Array;
  export default bytes;
}
declare module 'capstan.worker' {
  const source: string;
  export default source;
}
