//! [`Program`], one compiled function.

use crate::ShaderError;
use crate::machine::{Endless, Machine};
use crate::number::{Narrowed, ShaderNumber};
use crate::source::Source;
use crate::tape::Tape;
use std::any::Any;
use std::cell::RefCell;
use std::sync::{Arc, Weak};

/// Directions that [`Program::run_many`] takes at a time.
const WIDTH: usize = 32;

/// Machines that a thread keeps for its next calls.
const KEPT: usize = 16;

/// A machine of a program, over whatever number it was made for, with its constants in place.
struct Idle {
    program: Weak<()>,
    machine: Box<dyn Any>,
}

thread_local! {
    static IDLE: RefCell<Vec<Idle>> = const { RefCell::new(Vec::new()) };
}

/// One function of a shader, ready to run with any [`ShaderNumber`] on any thread.
///
/// Its arguments are a row of numbers: the scalars of each argument in order. Its results are those of the value that it returns
/// and then those of its `out` arguments. Truth values are 1 and 0.
#[derive(Debug)]
pub struct Program {
    name: String,
    source: Arc<Source>,
    tape: Tape,
    steps: u64,
    /// What tells its machines from those of other programs.
    identity: Arc<()>,
}

impl Program {
    pub(crate) fn new(name: String, source: Arc<Source>, tape: Tape, steps: u64) -> Self {
        Self {
            name,
            source,
            tape,
            steps,
            identity: Arc::new(()),
        }
    }

    /// The function's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many numbers it takes.
    pub fn inputs(&self) -> usize {
        self.tape.inputs.len()
    }

    /// How many numbers it gives.
    pub fn outputs(&self) -> usize {
        self.tape.outputs.len()
    }

    /// How many operations it was compiled to.
    pub fn operations(&self) -> usize {
        self.tape.ops.len()
    }

    /// Runs the function once, for all lanes of the numbers. `parameters` has each component of each of the shader's parameters.
    ///
    /// # Errors
    /// If a loop goes on for more steps than are allowed; the results are then NaN.
    ///
    /// # Panics
    /// If the slices have other lengths than the function has parameters, inputs and outputs.
    pub fn run<R: ShaderNumber>(
        &self,
        parameters: &[R],
        inputs: &[R],
        outputs: &mut [R],
    ) -> Result<(), ShaderError> {
        self.check(parameters.len(), inputs.len(), outputs.len());
        R::narrow(Job {
            program: self,
            parameters,
            inputs,
            outputs,
        })
    }

    /// Runs the function `n` times. Call `k` takes `inputs[k·i..]`, i the number of its inputs, and gives `outputs[k·o..]`.
    ///
    /// # Errors
    /// As [`Program::run`]. Calls that were run together have NaN then.
    ///
    /// # Panics
    /// As [`Program::run`].
    pub fn run_many<R: ShaderNumber>(
        &self,
        parameters: &[R],
        inputs: &[R],
        outputs: &mut [R],
    ) -> Result<(), ShaderError> {
        let (i, o) = (self.inputs().max(1), self.outputs().max(1));
        self.check(parameters.len(), self.inputs(), self.outputs());
        assert!(
            inputs.len().is_multiple_of(i) && inputs.len() / i == outputs.len() / o,
            "as many rows of inputs as of outputs"
        );
        let mut machine = self.take::<R>(WIDTH);
        for (&register, &x) in self.tape.parameters.iter().zip(parameters) {
            machine.real_mut(register).fill(x);
        }
        let mut worst = Ok(());
        let groups = inputs.chunks(i * WIDTH).zip(outputs.chunks_mut(o * WIDTH));
        for (inputs, outputs) in groups {
            let rows = inputs.len() / i;
            for (column, &register) in self.tape.inputs.iter().enumerate() {
                let numbers = machine.real_mut(register);
                for row in 0..WIDTH {
                    // The last row again, where there are fewer than the width: no new branch, no new loop.
                    numbers[row] = inputs[row.min(rows - 1) * i + column];
                }
            }
            match machine.run(&self.tape, self.steps) {
                Ok(()) => {
                    for (column, &register) in self.tape.outputs.iter().enumerate() {
                        let numbers = machine.real(register);
                        for row in 0..rows {
                            outputs[row * o + column] = numbers[row];
                        }
                    }
                }
                Err(endless) => {
                    outputs.fill(R::lit(f64::NAN));
                    worst = Err(self.endless(endless));
                }
            }
        }
        self.give_back(machine);
        worst
    }

    fn check(&self, parameters: usize, inputs: usize, outputs: usize) {
        assert_eq!(parameters, self.tape.parameters.len(), "parameters");
        assert_eq!(inputs, self.tape.inputs.len(), "inputs");
        assert_eq!(outputs, self.tape.outputs.len(), "outputs");
    }

    fn endless(&self, endless: Endless) -> ShaderError {
        let byte = self.tape.loops[endless.0 as usize] as usize;
        let mut error = self.source.error_at(byte, "");
        let line = error.place.as_ref().map_or(0, |p| p.line);
        error.message = format!(
            "`{}` did not end after {} steps, in the loop at line {line}",
            self.name, self.steps
        );
        error.with_help(format!(
            "give the loop an end that it reaches, or let it run longer: step_limit={}",
            self.steps.saturating_mul(100)
        ))
    }

    /// A machine that is idle on this thread, or a new one.
    fn take<R: ShaderNumber>(&self, width: usize) -> Box<Machine<R>> {
        let fits = |idle: &Idle| {
            let machine = idle.machine.downcast_ref::<Machine<R>>();
            std::ptr::eq(idle.program.as_ptr(), Arc::as_ptr(&self.identity))
                && machine.is_some_and(|m| m.width == width)
        };
        let found = IDLE.with_borrow_mut(|all| {
            let at = all.iter().position(fits)?;
            Some(all.swap_remove(at).machine)
        });
        found
            .and_then(|machine| machine.downcast().ok())
            .unwrap_or_else(|| Box::new(Machine::new(&self.tape, width)))
    }

    fn give_back<R: ShaderNumber>(&self, machine: Box<Machine<R>>) {
        IDLE.with_borrow_mut(|all| {
            if all.len() >= KEPT {
                all.retain(|idle| idle.program.strong_count() > 0);
                all.truncate(KEPT - 1);
            }
            all.push(Idle {
                program: Arc::downgrade(&self.identity),
                machine,
            });
        });
    }
}

/// One call, in whichever numbers are fastest.
struct Job<'a, R> {
    program: &'a Program,
    parameters: &'a [R],
    inputs: &'a [R],
    outputs: &'a mut [R],
}

impl<R: ShaderNumber> Narrowed<R> for Job<'_, R> {
    type Output = Result<(), ShaderError>;

    fn same(self) -> Self::Output {
        self.split::<R>(1, |x, _| *x, |x, _, y| *x = y)
    }

    fn nothing(self) -> Self::Output {
        self.outputs.fill(R::lit(f64::NAN));
        Ok(())
    }

    fn split<S: ShaderNumber>(
        self,
        width: usize,
        split: fn(&R, usize) -> S,
        join: fn(&mut R, usize, S),
    ) -> Self::Output {
        let tape = &self.program.tape;
        let mut machine = self.program.take::<S>(width);
        let parameters = tape.parameters.iter().zip(self.parameters);
        for (&register, x) in parameters.chain(tape.inputs.iter().zip(self.inputs)) {
            for (k, y) in machine.real_mut(register).iter_mut().enumerate() {
                *y = split(x, k);
            }
        }
        let result = machine.run(tape, self.program.steps);
        for (&register, x) in tape.outputs.iter().zip(self.outputs) {
            match result {
                Ok(()) => {
                    for (k, &y) in machine.real(register).iter().enumerate() {
                        join(x, k, y);
                    }
                }
                Err(_) => *x = R::lit(f64::NAN),
            }
        }
        self.program.give_back(machine);
        result.map_err(|endless| self.program.endless(endless))
    }
}
