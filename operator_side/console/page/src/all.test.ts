// Every test, bundled into one run.
import "./arm.test.ts";
import "./arrival.test.ts";
import "./camera.test.ts";
import "./clearance.test.ts";
import "./gamepad.test.ts";
import "./hand.test.ts";
import "./margin.test.ts";
import "./pace.test.ts";
import "./reason.test.ts";
import "./repeat.test.ts";
import "./shapes.test.ts";
import "./step.test.ts";
import "./stick.test.ts";
import "./world.test.ts";
