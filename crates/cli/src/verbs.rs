//! The list of verbs: what the help says of each, and the module that does it.

/// An enum of verbs, each with the arguments of its module, and `run`, which calls that module.
macro_rules! verbs {
    ($list:ident: $($(#[doc = $help:literal])+ $(#[cfg($on:meta)])? $verb:ident($module:ident $(, $more:expr)?),)+) => {
        #[derive(clap::Subcommand, Debug)]
        enum $list {
            $($(#[doc = $help])+ $(#[cfg($on)])? $verb($module::Arguments),)+
        }

        impl $list {
            fn run(&self) -> Result<(), $crate::Failure> {
                match self {
                    $($(#[cfg($on)])? Self::$verb(arguments) => $module::run(arguments $(, $more)?),)+
                }
            }
        }
    };
}
