// Validates the glTF files named on the command line with Khronos' validator.
// Prints every issue. Exit: 0 none, 1 any (informational ones too), 2 usage, 77 no validator.
//
// `npm install` here puts the validator beside this script; NODE_PATH may name another place.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename } from 'node:path';

const SEVERITIES = ['error', 'warning', 'info', 'hint'];

function loadValidator() {
    try {
        return createRequire(import.meta.url)('gltf-validator');
    } catch {
        console.error('skip: gltf-validator is not installed (npm install in tests/validator)');
        process.exit(77);
    }
}

async function countIssues(validator, file) {
    const bytes = new Uint8Array(readFileSync(file));
    const report = await validator.validateBytes(bytes, { uri: basename(file), maxIssues: 20 });
    const { issues, info } = report;
    for (const { severity, code, message, pointer } of issues.messages)
        console.log(`${file}: ${SEVERITIES[severity]} ${code} at ${pointer ?? 'file'}: ${message}`);
    const count = issues.numErrors + issues.numWarnings + issues.numInfos + issues.numHints;
    console.log(`${file}: ${count} issues, ${info?.totalVertexCount} vertices, ` +
                `${info?.totalTriangleCount} triangles`);
    return count;
}

const files = process.argv.slice(2);
if (files.length === 0) {
    console.error('usage: validate_glb.mjs FILE...');
    process.exit(2);
}
const validator = loadValidator();
let total = 0;
for (const file of files)
    total += await countIssues(validator, file);
process.exitCode = total === 0 ? 0 : 1;
