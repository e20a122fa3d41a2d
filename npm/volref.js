#!/usr/bin/env node
// The program volref, with the arguments of this script.

import { spawnSync } from 'node:child_process';
import { VolrefError, program } from './program.js';

const SIGNALS = ['SIGINT', 'SIGTERM', 'SIGHUP'];

function file() {
  try {
    return program();
  } catch (error) {
    if (!(error instanceof VolrefError)) throw error;
    console.error(error.message);
    return process.exit(2);
  }
}

const ran = spawnSync(file(), process.argv.slice(2), { stdio: 'inherit' });
if (ran.error) console.error(`cannot run volref: ${ran.error.message}`);
if (SIGNALS.includes(ran.signal)) process.kill(process.pid, ran.signal);
process.exitCode = ran.status ?? 2;
