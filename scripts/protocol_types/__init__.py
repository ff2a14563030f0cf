"""The declared facts of the protocol in the words of each language."""
