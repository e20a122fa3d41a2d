#!/usr/bin/env node
// The program volref, with the arguments of this script.

import { spawn } from 'node:child_process';
import { VolrefError, program } from './program.js';

function file() {
  try {
    return program();
  } catch (error) {
    if (!(error instanceof VolrefError)) throw error;
    console.error(error.message);
    return process.exit(2);
  }
}

const child = spawn(file(), process.argv.slice(2), { stdio: 'inherit' });
// A terminal sends this one to both.
process.on('SIGINT', () => {});
for (const signal of ['SIGTERM', 'SIGHUP']) process.on(signal, () => child.kill(signal));
child.on('error', (error) => {
  console.error(`cannot run volref: ${error.message}`);
  process.exitCode = 2;
});
child.on('exit', (code, signal) => {
  process.removeAllListeners();
  if (signal) process.kill(process.pid, signal);
  process.exitCode = code ?? 2;
});
